"""The same picture gives the same bits as the program ``estimate``, whatever the type and layout of the array."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import motion_blur
from conftest import png

Pixels = npt.NDArray[Any]


def command_line(path: Path, *options: str) -> dict[str, Any]:
    """What ``estimate --json`` says, with the numbers as doubles: JSON keeps every bit of them."""
    program = os.environ.get("BLUR_ESTIMATE")
    if program is None:
        assert os.environ.get("CI") != "true", "BLUR_ESTIMATE must name the program estimate"
        pytest.skip("BLUR_ESTIMATE does not name the program estimate")
    printed = subprocess.run([program, "--json", *options, path], check=True, capture_output=True, text=True).stdout
    record: dict[str, Any] = json.loads(printed)
    return record


def same_bits(record: motion_blur.Record, line: dict[str, Any]) -> None:
    """Every field that the program prints too is equal; the program knows of files, so it has more."""
    ours = record.to_dict()
    # The program does not repeat a scale that it was given, and reads single files: there is no frame before.
    absent = {"tracked"}
    names = [name for name in ours if name not in absent]
    assert [name for name in line if name in names] == names
    assert {name: line[name] for name in names} == {name: ours[name] for name in names}


def scenes() -> dict[str, Pixels]:
    def simulated(length: float, angle: float, seed: int) -> Pixels:
        return motion_blur.simulate((192, 256), length, angle, noise_db=36.0, seed=seed)

    grey = simulated(18.3, 57.0, 5)
    colour = np.stack([simulated(12.0, 140.0, seed) for seed in (6, 7, 8)], axis=2)
    deep = motion_blur.simulate((128, 160), 9.5, 5.0, noise_db=60.0, seed=9, quantize=False)
    return {
        "grey": grey,
        "colour": colour,
        "deep": np.clip(257 * deep, 0, 65535).round().astype(np.uint16),
        "odd": grey[:149, :211].copy(),
        "sharp": motion_blur.dead_leaves(128, 128, seed=2).round().astype(np.uint8),
    }


@pytest.mark.parametrize("name", ["grey", "colour", "deep", "odd", "sharp"])
@pytest.mark.parametrize("linearize", [False, True])
def test_arrays_give_the_bits_of_the_command_line(tmp_path: Path, name: str, linearize: bool) -> None:
    pixels = scenes()[name]
    path = tmp_path / "picture.png"
    path.write_bytes(png(pixels))
    line = command_line(path, "--linearize", "on" if linearize else "off", "--exposure", "20ms", "--scale", "0.7789mm/px")
    meter = motion_blur.Meter(linearize=linearize, exposure_s=0.02, scale_m_per_px=0.7789e-3)
    same_bits(meter.measure(pixels), line)
    same_bits(meter.measure(motion_blur.read(path, linearize=linearize)), line)
    same_bits(meter.measure(motion_blur.read(path.read_bytes(), linearize=linearize)), line)


def test_pictures_that_were_read_give_the_bits_of_the_command_line(fixtures: Path, data: Path) -> None:
    for path in [fixtures / "sample.png", data / "real_photos/text_motion.jpg", data / "real_photos/text_defocus.jpg"]:
        picture = motion_blur.read(path)
        same_bits(motion_blur.estimate(picture, exposure_s=picture.exposure_s), command_line(path))


def test_an_acceleration_has_the_bits_of_the_command_line(tmp_path: Path) -> None:
    pixels = motion_blur.simulate((256, 256), 40.0, 20.0, accel_ratio=0.5, noise_db=45.0, seed=4)
    (tmp_path / "a.png").write_bytes(png(pixels))
    line = command_line(tmp_path / "a.png", "--accel", "--exposure", "20ms", "--scale", "1mm/px")
    record = motion_blur.estimate(pixels, acceleration=True, exposure_s=0.02, scale_m_per_px=1e-3)
    assert record.accel_detected and record.accel_m_s2 is not None
    same_bits(record, line)


@pytest.mark.parametrize("method", ["phase-autocorrelation", "dct-radon+dct-pseudo-cepstrum"])
def test_every_kind_of_method_has_the_bits_of_the_command_line(fixtures: Path, method: str) -> None:
    path = fixtures / "sample.png"
    same_bits(motion_blur.estimate(motion_blur.read(path), method=method), command_line(path, "--method", method))


def layouts(pixels: Pixels) -> dict[str, Pixels]:
    """Views and copies of one picture."""
    padded = np.zeros((pixels.shape[0] + 3, pixels.shape[1] + 5, *pixels.shape[2:]), pixels.dtype)
    inside = padded[1:-2, 2:-3]
    inside[...] = pixels
    apart = np.zeros((pixels.shape[0], 2 * pixels.shape[1], *pixels.shape[2:]), pixels.dtype)[:, ::2]
    apart[...] = pixels
    read_only = pixels.copy()
    read_only.flags.writeable = False
    return {
        "columns first": np.asfortranarray(pixels),
        "inside a larger one": inside,
        "every other column": apart,
        "stored upside down": pixels[::-1].copy()[::-1],
        "stored mirrored": pixels[:, ::-1].copy()[:, ::-1],
        "read-only": read_only,
        "other byte order": pixels.astype(pixels.dtype.newbyteorder()),
    }


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
@pytest.mark.parametrize("channels", [1, 3])
def test_layouts_make_no_difference(blurred: Pixels, dtype: type[np.generic], channels: int) -> None:
    pixels: Pixels = blurred.astype(dtype) if channels == 1 else np.stack(3 * [blurred], 2).astype(dtype)
    expected = motion_blur.estimate(pixels)
    for name, view in layouts(pixels).items():
        assert motion_blur.estimate(view) == expected, name


def test_rows_that_are_whole_are_not_copied() -> None:
    # Rows that begin far apart in a larger array.
    pixels = motion_blur.simulate((64, 64), 8.0, 0.0, seed=1)
    wide = np.zeros((64, 1 << 22), np.uint8)
    wide[:, :64] = pixels
    assert motion_blur.estimate(wide[:, :64]) == motion_blur.estimate(pixels)


def test_depths_and_types_share_one_scale(blurred: Pixels) -> None:
    expected = motion_blur.estimate(blurred)
    assert motion_blur.estimate(blurred.astype(np.uint16) * 257) == expected
    assert motion_blur.estimate(blurred.astype(np.float32)) == expected
    assert motion_blur.estimate(blurred.astype(np.float64)) == expected
    assert motion_blur.estimate(blurred[:, :, None]) == expected


def test_orders_of_colours_and_alpha() -> None:
    rgb = np.stack([motion_blur.simulate((96, 96), 10.0, 60.0, seed=seed) for seed in (1, 2, 3)], axis=2)
    expected = motion_blur.estimate(rgb)
    assert motion_blur.estimate(rgb[:, :, ::-1], order="bgr") == expected
    assert motion_blur.estimate(rgb[:, :, ::-1]) != expected
    alpha = np.full((96, 96, 1), 7, np.uint8)
    assert motion_blur.estimate(np.concatenate([rgb, alpha], 2)) == expected
    assert motion_blur.estimate(np.concatenate([rgb[:, :, ::-1], alpha], 2), order="bgr") == expected
    grey_alpha = np.concatenate([rgb[:, :, :1], alpha], 2)
    assert motion_blur.estimate(grey_alpha) == motion_blur.estimate(rgb[:, :, 0])
