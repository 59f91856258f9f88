"""What several tests need: the project's files, and pictures of known truth."""

import os
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import motion_blur

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def fixtures() -> Path:
    return ROOT / "fixtures"


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real photographs; without it a test is skipped, unless BLUR_REQUIRE_DATA is set."""
    folder = Path(os.environ.get("BLUR_DATA", ROOT / ".." / "shared" / "data"))
    if not folder.is_dir():
        assert "BLUR_REQUIRE_DATA" not in os.environ, f"no data in {folder}: set BLUR_DATA to the folder"
        pytest.skip(f"no data in {folder}: set BLUR_DATA to the folder")
    return folder


@pytest.fixture(scope="session")
def blurred() -> npt.NDArray[np.uint8]:
    """24 px along 30 degrees, 35 dB of noise."""
    return motion_blur.simulate((256, 320), 24.0, 30.0, noise_db=35.0, seed=3)


def png(pixels: npt.NDArray[Any]) -> bytes:
    """A PNG file of uint8 or uint16 samples, rows x columns or rows x columns x 3, without any library of pictures."""
    rows, columns = pixels.shape[:2]
    big_endian = pixels.astype(pixels.dtype.newbyteorder(">")).reshape(rows, -1)
    lines = b"".join(b"\0" + line.tobytes() for line in big_endian)

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    colour = 0 if pixels.ndim == 2 else 2
    header = struct.pack(">IIBBBBB", columns, rows, 8 * pixels.itemsize, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
