"""What a measurement is told and what it answers."""

import copy
import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import motion_blur
from conftest import png
from motion_blur import MotionBlurError, Record

Pixels = npt.NDArray[Any]


def test_the_truth_lies_within_the_uncertainty(blurred: Pixels) -> None:
    record = motion_blur.estimate(blurred)
    assert record.length_std_px is not None and record.angle_std_deg is not None
    # Four standard deviations, and 0.02 px for what the record does not count: the rounding to eight bits.
    assert abs(record.length_px - 24.0) < 4 * record.length_std_px + 0.02
    assert abs(record.angle_deg - 30.0) < 4 * record.angle_std_deg + 0.02
    assert record.status == "ok" and record.reason is None


def test_speed_is_scale_times_length_over_exposure(blurred: Pixels) -> None:
    record = motion_blur.estimate(
        blurred, exposure_s=0.02, exposure_std_s=1e-4, scale_m_per_px=7e-4, scale_std_m_per_px=3e-6
    )
    speed = 7e-4 * record.length_px / 0.02
    assert record.speed_m_s == pytest.approx(speed, rel=1e-15)
    assert record.length_std_px is not None and record.speed_std_m_s is not None
    relative = math.hypot(record.length_std_px / record.length_px, 1e-4 / 0.02, 3e-6 / 7e-4)
    assert record.speed_std_m_s == pytest.approx(speed * relative, rel=1e-12)
    assert record.coverage_k == 2.0 and record.speed_expanded_m_s == 2 * record.speed_std_m_s


def test_a_camera_gives_speed_and_turn(blurred: Pixels) -> None:
    height, width = blurred.shape
    camera = motion_blur.Camera(width, height, fx_px=800, fy_px=800, cx_px=(width - 1) / 2, cy_px=(height - 1) / 2)
    moved = motion_blur.estimate(blurred, camera=camera, distance_m=2.0, exposure_s=0.01)
    assert moved.scale_m_per_px == pytest.approx(2.0 / 800, rel=1e-12)
    turned = motion_blur.estimate(blurred, camera=camera, rotating=True, exposure_s=0.01)
    # Both ends of the blur are half its length from the axis.
    assert turned.angular_rate_rad_s == pytest.approx(2 * math.atan(turned.length_px / 2 / 800) / 0.01, rel=1e-12)
    assert turned.speed_m_s is None


def test_a_sharp_picture_has_no_speed() -> None:
    sharp = motion_blur.dead_leaves(256, 256, seed=1).round().astype(np.uint8)
    record = motion_blur.estimate(sharp, exposure_s=0.01, scale_m_per_px=1e-3)
    assert record.status == "no_motion_blur" and record.reason and record.speed_m_s is None


def test_a_record_is_plain_unchanging_data(blurred: Pixels) -> None:
    record = motion_blur.estimate(blurred, exposure_s=0.02, scale_m_per_px=1e-3)
    assert record == motion_blur.estimate(blurred, exposure_s=0.02, scale_m_per_px=1e-3)
    assert record != motion_blur.estimate(blurred)
    assert eval(repr(record), {"Record": Record}) == record
    assert copy.deepcopy(record) == record
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(record, protocol)) == record
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.length_px = 1.0  # type: ignore[misc]
    fields = record.to_dict()
    assert None not in fields.values() and "direction_deg" not in fields and record.direction_deg is None
    assert list(fields)[:5] == ["width", "height", "method", "linearized", "tracked"]


def test_a_meter_measures_one_picture_after_the_other(blurred: Pixels) -> None:
    meter = motion_blur.Meter(exposure_s=0.01, scale_m_per_px=1e-3, tracking=False, directed=False)
    other = motion_blur.simulate((128, 128), 8.0, 100.0, seed=2)
    for picture in (blurred, other, blurred):
        assert meter.measure(picture) == motion_blur.estimate(picture, exposure_s=0.01, scale_m_per_px=1e-3)
        meter.reset()


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((10, 10), np.uint8), "the picture is 10x10 pixels; at least 32x32 are needed"),
        (np.zeros((64, 64), np.uint8), "all pixels have the value 0"),
        (np.zeros((0, 64), np.uint8), "the picture is 64x0 pixels"),
        (np.full((64, 64), np.nan), "row 0, column 0 is NaN"),
        (np.zeros(64, np.uint8), "shape [64]"),
        (np.zeros((64, 64, 5), np.uint8), "shape [64, 64, 5]"),
        (np.zeros((64, 64), np.int32), "samples of type int32"),
        (np.zeros((64, 64), bool), "samples of type bool"),
        (np.zeros((64, 64), complex), "samples of type complex128"),
        ([[1, 2], [3, 4]], "not of type list"),
        (None, "not of type NoneType"),
    ],
)
def test_what_is_no_picture_is_refused_with_its_numbers(image: Any, message: str) -> None:
    with pytest.raises(MotionBlurError, match="^[a-z]") as caught:
        motion_blur.estimate(image)
    assert message in str(caught.value)
    assert isinstance(caught.value, ValueError)
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is MotionBlurError and str(again) == str(caught.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "wiener"}, "'wiener'"),
        ({"exposure_s": -1.0}, "exposure (s) = -1"),
        ({"exposure_s": math.nan}, "NaN"),
        ({"exposure_s": 1.0, "exposure_std_s": -0.5}, "-0.5"),
        ({"scale_m_per_px": 0.0}, "scale (m/px) = 0"),
        ({"length_range_px": (1.0, 9.0)}, "shortest length (px) = 1"),
        ({"length_range_px": (9.0, 9.0)}, "longest length (px) = 9"),
        ({"window": "kaiser"}, "'kaiser'"),
        ({"order": "rbg"}, "'rbg'"),
        ({"distance_m": 1.0}, "camera"),
        ({"rotating": True}, "camera"),
        ({"method": "phase-autocorrelation", "acceleration": True}, "cannot look for an acceleration"),
    ],
)
def test_impossible_options_are_refused_with_their_numbers(
    blurred: Pixels, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(MotionBlurError) as caught:
        motion_blur.estimate(blurred, **options)
    assert message in str(caught.value)
    with pytest.raises(MotionBlurError) as caught:
        motion_blur.Meter(**options).measure(blurred)
    assert message in str(caught.value)


def test_a_misspelt_option_is_refused(blurred: Pixels) -> None:
    with pytest.raises(TypeError, match="'exposure'"):
        motion_blur.estimate(blurred, exposure=0.01)  # type: ignore[call-arg]
    # One picture has no frame before it.
    with pytest.raises(TypeError, match="'tracking'"):
        motion_blur.estimate(blurred, tracking=True)  # type: ignore[call-arg]


def test_a_camera_of_another_shape_is_refused(blurred: Pixels) -> None:
    camera = motion_blur.Camera(1000, 1000, fx_px=800, fy_px=800, cx_px=500, cy_px=500)
    with pytest.raises(MotionBlurError, match="calibrated at 1000x1000"):
        motion_blur.estimate(blurred, camera=camera, distance_m=1.0, exposure_s=0.01)


def test_damaged_files_are_refused() -> None:
    whole = (np.random.default_rng(1).integers(0, 256, (64, 64))).astype(np.uint8)
    content = png(whole)
    assert motion_blur.read(content).luma.shape == (64, 64)
    for damaged, message in [
        (b"", "empty"),
        (b"no picture", "not a picture"),
        (content[: len(content) // 2], "cannot be decoded"),
    ]:
        with pytest.raises(MotionBlurError, match=message):
            motion_blur.read(damaged)
    with pytest.raises(MotionBlurError, match="/nowhere.png: cannot be read"):
        motion_blur.read("/nowhere.png")
    with pytest.raises(MotionBlurError, match="linearize = 'sometimes'"):
        motion_blur.read(content, linearize="sometimes")  # type: ignore[arg-type]


def test_a_picture_is_read_only_and_goes_through_pickle(fixtures: Any) -> None:
    picture = motion_blur.read(fixtures / "sample.png")
    assert not picture.luma.flags.writeable and picture.exposure_s is None and picture.note is None
    again = pickle.loads(pickle.dumps(picture))
    assert motion_blur.estimate(again) == motion_blur.estimate(picture)
