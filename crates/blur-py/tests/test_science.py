"""Against formulas, and against scipy and OpenCV where they compute the same."""

import csv
import pickle
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from scipy import signal  # type: ignore[import-untyped]

import motion_blur
from motion_blur import MotionBlurError

Pixels = npt.NDArray[Any]


def otf(kernel: Pixels, u: Pixels, v: Pixels) -> Pixels:
    """The transform of a centred kernel at frequencies in cycles per pixel."""
    rows, columns = kernel.shape
    y, x = np.mgrid[:rows, :columns]
    y, x = y - rows // 2, x - columns // 2
    phase = u[:, None, None] * x + v[:, None, None] * y
    value: Pixels = (kernel * np.exp(-2j * np.pi * phase)).sum((1, 2))
    return value


def test_a_kernel_along_the_rows_is_a_sinc() -> None:
    # Sampled once a pixel, the line's transform sinc(L u), times that of the pixel's square, comes with its copies:
    # sum_k sinc(L (u - k)) sinc(u - k), here to 4000 copies each way, which leaves less than 1 / (pi^2 L 4000).
    u, copies = np.linspace(0.0, 0.5, 51), np.arange(-4000, 4001)[:, None]
    for length in (7.3, 20.0, 33.8):
        expected = (np.sinc(length * (u - copies)) * np.sinc(u - copies)).sum(0)
        found = otf(motion_blur.psf(length, 0.0), u, np.zeros_like(u))
        assert np.abs(found - expected).max() < 1e-5


def test_a_weight_is_the_share_of_the_exposure_in_its_pixel() -> None:
    for length, angle, ratio in [(20.0, 30.0, 0.0), (11.5, 118.0, 0.0), (25.0, 200.0, 0.7)]:
        kernel = motion_blur.psf(length, angle, ratio)
        time = (np.arange(1_000_000) + 0.5) / 1_000_000
        along = length * ((1 - ratio) * time + ratio * time**2 - 0.5)
        edges = [np.arange(side + 1) - side / 2 for side in kernel.shape]
        place = (-along * np.sin(np.radians(angle)), along * np.cos(np.radians(angle)))
        counted = np.histogram2d(*place, bins=edges)[0] / time.size
        assert np.abs(kernel - counted).max() < 1e-5 and abs(kernel.sum() - 1.0) < 1e-12


def test_a_kernel_is_put_in_the_middle() -> None:
    kernel = motion_blur.psf(9.0, 45.0, 0.4)
    square = motion_blur.psf(9.0, 45.0, 0.4, size=21)
    edge = (21 - kernel.shape[0]) // 2
    assert square.shape == (21, 21) and np.array_equal(square[edge:-edge, edge:-edge], kernel)
    for size in (20, 5):
        with pytest.raises(MotionBlurError, match=f"{size}x{size}"):
            motion_blur.psf(9.0, 45.0, size=size)
    with pytest.raises(MotionBlurError, match="ratio = 1.5"):
        motion_blur.psf(9.0, 45.0, 1.5)


def test_the_simulator_multiplies_waves_by_the_sinc() -> None:
    # A wave of whole periods, far from the border: numpy's sinc is the transfer function.
    y, x = np.mgrid[:300, :400]
    for u, v in [(0.05, 0.0), (0.03, -0.07), (0.11, 0.09)]:
        scene = 127.5 + 100 * np.cos(2 * np.pi * (u * x + v * y))
        length, angle = 13.7, 25.0
        picture = motion_blur.simulate(scene, length, angle, quantize=False)
        s = u * np.cos(np.radians(angle)) - v * np.sin(np.radians(angle))
        rows, columns = [(big - small) // 2 for big, small in zip(scene.shape, picture.shape, strict=True)]
        expected = 127.5 + np.sinc(length * s) * (scene[rows:, columns:][: picture.shape[0], : picture.shape[1]] - 127.5)
        assert np.abs(picture - expected)[40:-40, 40:-40].max() < 0.05


def test_the_simulator_convolves_as_scipy() -> None:
    # A smooth scene is nearly band-limited to a fifth of a cycle, where a kernel with twenty steps a pixel has the sinc's values.
    rng = np.random.default_rng(5)
    scene = 127.5 + 400 * cv2.GaussianBlur(rng.standard_normal((240, 300)), (0, 0), 3.0)
    kernel = np.full((1, 15), 1 / 15)
    expected = signal.fftconvolve(scene, kernel, mode="valid")
    picture = motion_blur.simulate(scene, 15.0, 0.0, quantize=False)
    # A sum over 15 pixels has the transform sin(15 pi u) / (15 sin(pi u)) in place of sinc(15 u): relative to the scene's
    # contrast the difference is sinc(15 u) (pi u)^2 / 6, below 3e-4 for the frequencies of this scene.
    middle = picture[40:-40, 40:-40]
    shift = (expected.shape[1] - picture.shape[1]) // 2
    beside = expected[40 : 40 + middle.shape[0], 40 + shift : 40 + shift + middle.shape[1]]
    assert np.abs(middle - beside).max() < 1e-3 * np.ptp(scene)


def test_noise_has_the_power_asked_for() -> None:
    scene = np.full((400, 400), 127.5)
    noise = motion_blur.simulate(scene, 0.0, 0.0, noise_db=30.0, seed=1, quantize=False) - 127.5
    # 160000 pixels know the standard deviation to 1 / sqrt(320000), 0.2 %.
    assert noise.std() == pytest.approx(255 * 10**-1.5, rel=0.01)
    again = motion_blur.simulate(scene, 0.0, 0.0, noise_db=30.0, seed=1, quantize=False) - 127.5
    other = motion_blur.simulate(scene, 0.0, 0.0, noise_db=30.0, seed=2, quantize=False) - 127.5
    assert np.array_equal(noise, again) and not np.array_equal(noise, other)


def psnr(a: Pixels, b: Pixels) -> float:
    return float(-10 * np.log10(np.mean((a.astype(float) - b) ** 2) / 255**2))


def scipy_like_wiener(picture: Pixels, kernel: Pixels, best_for: Pixels) -> Pixels:
    """The classical filter on the periodic picture, with the constant noise-to-signal ratio that suits the truth best."""
    transfer = np.fft.fft2(np.fft.ifftshift(kernel_on(picture.shape, kernel)))
    spectrum = np.fft.fft2(picture)
    restored = [
        np.fft.ifft2(spectrum * transfer.conj() / (abs(transfer) ** 2 + ratio)).real for ratio in 10.0 ** np.arange(-4, 0, 0.5)
    ]
    return max(restored, key=lambda scene: psnr(scene[32:-32, 32:-32], best_for[32:-32, 32:-32]))


def kernel_on(shape: tuple[int, ...], kernel: Pixels) -> Pixels:
    whole = np.zeros(shape)
    rows, columns = kernel.shape
    top, left = shape[0] // 2 - rows // 2, shape[1] // 2 - columns // 2
    whole[top : top + rows, left : left + columns] = kernel
    return whole


@pytest.mark.parametrize("colour", [False, True])
def test_restoring_with_the_measured_blur_brings_the_scene_back(colour: bool) -> None:
    length, angle = 20.0, 35.0
    scene = motion_blur.dead_leaves(320, 320, seed=8)
    picture = motion_blur.simulate(scene, length, angle, noise_db=35.0, seed=8)
    top, left = [(big - small) // 2 for big, small in zip(scene.shape, picture.shape, strict=True)]
    sharp = scene[top:, left:][: picture.shape[0], : picture.shape[1]]
    image = np.stack(3 * [picture], 2) if colour else picture
    restored = motion_blur.restore(image, motion_blur.estimate(image))
    assert restored.shape == image.shape and restored.dtype == np.float32
    plane = restored[:, :, 1] if colour else restored
    classical = scipy_like_wiener(picture, motion_blur.psf(length, angle), sharp)
    middle = (slice(32, -32), slice(32, -32))
    assert psnr(plane[middle], sharp[middle]) > psnr(picture[middle], sharp[middle]) + 4.0
    assert psnr(plane[middle], sharp[middle]) > psnr(classical[middle], sharp[middle])


def test_a_blur_by_numbers_is_that_of_its_record(blurred: Pixels) -> None:
    record = motion_blur.estimate(blurred)
    blur = motion_blur.Blur(record.length_px, record.angle_deg)
    assert np.array_equal(motion_blur.restore(blurred, record), motion_blur.restore(blurred, blur))
    default, *others = [motion_blur.restore(blurred, blur, method) for method in ("wiener", "richardson-lucy", "sliding-dct")]
    assert np.array_equal(motion_blur.restore(blurred, blur), default)
    assert not any(np.array_equal(default, other) for other in others)


def test_nothing_is_undone_where_nothing_moved() -> None:
    sharp = motion_blur.dead_leaves(128, 128, seed=1).round().astype(np.uint8)
    with pytest.raises(MotionBlurError, match="nothing to undo"):
        motion_blur.restore(sharp, motion_blur.estimate(sharp))
    with pytest.raises(MotionBlurError, match="'lucky'"):
        motion_blur.restore(sharp, motion_blur.Blur(5.0, 0.0), method="lucky")  # type: ignore[arg-type]
    with pytest.raises(MotionBlurError, match=r"a blur of 500.0 px"):
        motion_blur.restore(sharp, motion_blur.Blur(500.0, 0.0))


def test_grey_values_are_those_of_opencv(tmp_path: Path) -> None:
    colours = np.random.default_rng(3).integers(0, 256, (60, 80, 3)).astype(np.uint8)
    assert cv2.imwrite(str(tmp_path / "colours.png"), colours)
    luma = motion_blur.read(tmp_path / "colours.png").luma
    # OpenCV weighs the same way (BT.601) and rounds to whole grey levels.
    assert np.abs(luma - cv2.cvtColor(colours, cv2.COLOR_BGR2GRAY)).max() < 0.51


def zhang(data: Path) -> tuple[Pixels, list[Pixels]]:
    folder = data / "calib_zhang"
    points = [np.loadtxt(folder / name).reshape(-1, 2) for name in ["Model.txt", *(f"data{k}.txt" for k in range(1, 6))]]
    return points[0], points[1:]


def test_calibration_agrees_with_zhang(data: Path) -> None:
    board, views = zhang(data)
    found = motion_blur.calibrate(board, views, 640, 480, distortion=2, skew=True)
    # Zhang's own results, as published with his data.
    published = {"fx_px": 832.5, "fy_px": 832.53, "skew_px": 0.204494, "cx_px": 303.959, "cy_px": 206.585}
    for name, value in published.items():
        assert found.camera.parameters[name] == pytest.approx(value, abs=0.02), name
    assert found.camera.parameters["k1"] == pytest.approx(-0.228601, abs=2e-4)
    assert found.camera.parameters["k2"] == pytest.approx(0.190353, abs=1e-3)
    assert found.points == 5 * 256 and len(found.view_rms_px) == len(found.view_tilt_deg) == 5


def test_calibration_agrees_with_opencv(data: Path) -> None:
    board, views = zhang(data)
    flat = np.c_[board, np.zeros(len(board))].astype(np.float32)
    seen = [view.astype(np.float32)[:, None] for view in views]
    stop = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 1000, 1e-14)
    start = np.array([[800.0, 0, 320], [0, 800, 240], [0, 0, 1]])
    rms, matrix, lens, _, _, stds, *_ = cv2.calibrateCameraExtended(
        [flat] * 5, seen, (640, 480), start, np.zeros(5), flags=cv2.CALIB_USE_INTRINSIC_GUESS, criteria=stop
    )
    found = motion_blur.calibrate(board, views, 640, 480)
    names = ["fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"]
    theirs = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *lens.ravel()[:5]]
    for name, value, std in zip(names, theirs, stds.ravel(), strict=False):
        assert found.camera.parameters[name] == pytest.approx(value, abs=0.02 * float(std)), name
        assert found.camera.stds[name] == pytest.approx(float(std), rel=0.01), name
    assert found.rms_px == pytest.approx(rms, rel=1e-4)
    # Rays: OpenCV's own inverse is an iteration that ends early.
    pixels = np.array([[10.0, 20.0], [320.0, 240.0], [600.0, 470.0]])
    rays = cv2.undistortPoints(pixels[:, None], matrix, lens)[:, 0]
    assert np.abs(found.camera.unproject(pixels) - rays).max() < 1e-3
    back = found.camera.project(np.c_[found.camera.unproject(pixels), np.ones(3)])
    assert np.abs(back - pixels).max() < 1e-9


def test_a_board_is_found_where_opencv_finds_it(data: Path) -> None:
    path = data / "calib_opencv" / "left01.jpg"
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    board, found = motion_blur.find_board(picture, 9, 6, 0.025)
    assert board[1].tolist() == [0.025, 0.0] and board[-1].tolist() == pytest.approx([0.2, 0.125])
    theirs = cv2.findChessboardCorners(picture, (9, 6))[1].reshape(-1, 2)
    theirs = theirs if np.abs(theirs - found).max() < np.abs(theirs[::-1] - found).max() else theirs[::-1]
    # Without its refinement, OpenCV's corners are good to about half a pixel.
    assert np.abs(theirs - found).max() < 1.0
    with pytest.raises(MotionBlurError, match="no board of 8x7"):
        motion_blur.find_board(np.full((100, 100), 7, np.uint8) + np.eye(100, dtype=np.uint8), 8, 7, 1.0)


def test_corners_calibrate_as_opencv_did(fixtures: Path) -> None:
    with open(fixtures / "camera/corners.csv") as table:
        rows = list(csv.DictReader(table))
    count = 1 + max(int(row["view"]) for row in rows)
    views = [[(float(r["u_px"]), float(r["v_px"])) for r in rows if int(r["view"]) == k] for k in range(count)]
    board = [(i % 9, i // 9) for i in range(54)]
    found = motion_blur.calibrate(board, views, 640, 480)
    with open(fixtures / "camera/calibrations.csv") as table:
        for row in csv.DictReader(table):
            if row["case"] == "five" and row["std"]:
                assert found.camera.parameters[row["name"]] == pytest.approx(float(row["value"]), abs=0.01 * float(row["std"]))


def test_a_camera_is_plain_unchanging_data() -> None:
    covariance = np.zeros((10, 10))
    covariance[0, 0] = covariance[1, 1] = 4.0
    camera = motion_blur.Camera(640, 480, fx_px=500, fy_px=501, cx_px=320, cy_px=240, k1=-0.1, covariance=covariance)
    assert camera.stds["fx_px"] == 2.0 and camera.parameters["k1"] == -0.1 and camera.parameters["p2"] == 0.0
    assert np.array_equal(camera.covariance, covariance)
    again = pickle.loads(pickle.dumps(camera))
    assert again == camera and again != motion_blur.Camera(640, 480, fx_px=500, fy_px=501, cx_px=320, cy_px=240)
    assert (camera.width_px, camera.height_px) == (640, 480)
    with pytest.raises(MotionBlurError, match="fx_px = 0"):
        motion_blur.Camera(640, 480, fy_px=501)
    with pytest.raises(MotionBlurError, match="10 rows, not 1"):
        motion_blur.Camera(640, 480, fx_px=1, fy_px=1, covariance=np.zeros((1, 10)))
    with pytest.raises(TypeError, match="'f_px'"):
        motion_blur.Camera(640, 480, f_px=1)  # type: ignore[call-arg]
    with pytest.raises(MotionBlurError, match="2 views|1 views"):
        motion_blur.calibrate([(0, 0), (1, 0), (0, 1), (1, 1)], [[(0, 0), (9, 0), (0, 9), (9, 9)]], 64, 64)
