"""Pictures for the tests of the engines, and what one process finds in them."""

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import motion_blur
import rows

COUNT = 48


def png(pixels: npt.NDArray[np.uint8]) -> bytes:
    """A grey PNG file."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 0, 0, 0, 0)
    lines = b"".join(b"\0" + line.tobytes() for line in pixels)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def fill(folder: Path, count: int, side: int) -> None:
    """Pictures of known truth, one of them damaged and one without contrast."""
    for k in range(count):
        picture = motion_blur.simulate((side, side), 6.0 + k % 9, 11.0 * k, noise_db=40.0, seed=k)
        (folder / f"picture {k:03}.png").write_bytes(png(picture))
    whole = (folder / "picture 000.png").read_bytes()
    (folder / "damaged.png").write_bytes(whole[: len(whole) // 2])
    (folder / "empty.png").write_bytes(png(np.zeros((64, 64), np.uint8)))
    (folder / "no picture.txt").write_text("not to be measured")


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("pictures")
    fill(made, COUNT, 256)
    return made


@pytest.fixture(scope="session")
def expected(folder: Path) -> list[dict[str, Any]]:
    """The rows that one process finds, by name."""
    return [rows.row_of(str(path), path.read_bytes()) for path in rows.pictures_in(str(folder))]
