"""Measures the pictures in a folder on Ray Data: python ray_batch.py FOLDER -o records.parquet

Ray runs the task of a lost worker again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pyarrow as pa
import ray

import rows


def measure(batch: pa.Table) -> pa.Table:
    """One row for each path."""
    paths = batch.column("path").to_pylist()
    return pa.Table.from_pylist([rows.row_of(path, rows.read_bytes(path)) for path in paths], schema=rows.SCHEMA)


def start(workers: int) -> None:
    """Starts a local cluster whose workers know this folder."""
    folder = str(Path(__file__).parent)
    ray.init(
        num_cpus=workers, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": folder}}
    )


def run(folder: str, workers: int, batch_size: int = 16) -> list[dict[str, Any]]:
    """The rows of all pictures, on the cluster that runs or on a local one."""
    paths = [str(path) for path in rows.pictures_in(folder)]
    if not ray.is_initialized():
        start(workers)
    blocks = max(workers, -(-len(paths) // batch_size))
    data = ray.data.from_items([{"path": path} for path in paths], override_num_blocks=blocks)
    # The file is read where it is measured: only its path travels.
    measured = data.map_batches(measure, batch_format="pyarrow", batch_size=batch_size)
    found: list[dict[str, Any]] = measured.take_all()
    return found


def main() -> None:
    given = rows.arguments("Ray Data")
    rows.write(run(given.folder, given.workers), given.output)


if __name__ == "__main__":
    main()
