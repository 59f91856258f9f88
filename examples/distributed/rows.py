"""One picture, one row: what the three engines have in common."""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

import motion_blur

EXTENSIONS = (".png", ".jpg", ".jpeg", ".tif", ".tiff")

_TYPES = {"int": pa.int64(), "float": pa.float64(), "bool": pa.bool_(), "str": pa.string()}
SCHEMA = pa.schema(
    [
        ("name", pa.string()),
        *((field.name, _TYPES[str(field.type).split(" | ")[0]]) for field in dataclasses.fields(motion_blur.Record)),
        ("error", pa.string()),
    ]
)


def row_of(name: str, content: bytes) -> dict[str, Any]:
    """All fields of the record of a picture file, absent ones as None; or what is wrong with it as `error`.

    One thread: the engine has one worker a processor already.
    """
    row: dict[str, Any] = dict.fromkeys(SCHEMA.names)
    row["name"] = name
    try:
        picture = motion_blur.read(content)
        row.update(dataclasses.asdict(motion_blur.estimate(picture, exposure_s=picture.exposure_s)))
    except motion_blur.MotionBlurError as error:
        row["error"] = str(error)
    return row


def pictures_in(folder: str) -> list[Path]:
    """The picture files directly in a folder, sorted by name."""
    return sorted(path for path in Path(folder).iterdir() if path.suffix.lower() in EXTENSIONS)


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """The content of a file."""
    return Path(path).read_bytes()


def write(rows: Iterable[dict[str, Any]], output: str) -> None:
    """Writes rows, sorted by name, as Parquet or as one JSON object a line, by the extension."""
    ordered = sorted(rows, key=lambda row: str(row["name"]))
    if output.endswith(".parquet"):
        pq.write_table(pa.Table.from_pylist(ordered, schema=SCHEMA), output)
        return
    with open(output, "w", encoding="utf-8") as out:
        for row in ordered:
            out.write(json.dumps({name: value for name, value in row.items() if value is not None}) + "\n")


def arguments(engine: str) -> argparse.Namespace:
    """The command line of every engine."""
    parser = argparse.ArgumentParser(description=f"Measures the pictures in a folder on {engine}.")
    parser.add_argument("folder", help="folder of PNG, JPEG or TIFF files")
    parser.add_argument("-o", "--output", default="records.jsonl", help="a .jsonl or .parquet file [%(default)s]")
    parser.add_argument("--workers", type=int, default=2, help="worker processes of the local cluster [%(default)s]")
    return parser.parse_args()
