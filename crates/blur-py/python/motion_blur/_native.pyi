from collections.abc import Iterable
from os import PathLike
from typing import Any, Literal, TypeAlias, final

import numpy as np
import numpy.typing as npt

from ._data import Blur, Picture, Record

_Image: TypeAlias = npt.NDArray[Any] | Picture
_Order: TypeAlias = Literal["rgb", "bgr"]
_Window: TypeAlias = Literal["none", "hann"]

__all__ = [
    "Calibration",
    "Camera",
    "Meter",
    "MotionBlurError",
    "calibrate",
    "dead_leaves",
    "estimate",
    "estimate_batch",
    "find_board",
    "psf",
    "read",
    "restore",
    "simulate",
]

class MotionBlurError(ValueError): ...

def estimate(
    image: _Image,
    *,
    order: _Order = "rgb",
    method: str = ...,
    linearize: bool = ...,
    exposure_s: float | None = ...,
    exposure_std_s: float = ...,
    scale_m_per_px: float | None = ...,
    scale_std_m_per_px: float = ...,
    camera: Camera | None = ...,
    distance_m: float | None = ...,
    distance_std_m: float = ...,
    rotating: bool = ...,
    length_range_px: tuple[float, float] | None = ...,
    window: _Window | None = ...,
    acceleration: bool = ...,
) -> Record: ...
def estimate_batch(
    images: Iterable[_Image],
    *,
    threads: int | None = None,
    order: _Order = "rgb",
    method: str = ...,
    linearize: bool = ...,
    exposure_s: float | None = ...,
    exposure_std_s: float = ...,
    scale_m_per_px: float | None = ...,
    scale_std_m_per_px: float = ...,
    camera: Camera | None = ...,
    distance_m: float | None = ...,
    distance_std_m: float = ...,
    rotating: bool = ...,
    length_range_px: tuple[float, float] | None = ...,
    window: _Window | None = ...,
    acceleration: bool = ...,
) -> list[Record | MotionBlurError]: ...

@final
class Meter:
    def __new__(
        cls,
        *,
        order: _Order = "rgb",
        method: str = ...,
        linearize: bool = ...,
        exposure_s: float | None = ...,
        exposure_std_s: float = ...,
        scale_m_per_px: float | None = ...,
        scale_std_m_per_px: float = ...,
        camera: Camera | None = ...,
        distance_m: float | None = ...,
        distance_std_m: float = ...,
        rotating: bool = ...,
        length_range_px: tuple[float, float] | None = ...,
        window: _Window | None = ...,
        acceleration: bool = ...,
        tracking: bool = ...,
        directed: bool = ...,
    ) -> Meter: ...
    def measure(self, image: _Image) -> Record: ...
    def reset(self) -> None: ...

def read(source: bytes | str | PathLike[str], linearize: bool | Literal["auto"] = "auto") -> Picture: ...
def psf(
    length_px: float, angle_deg: float, accel_ratio: float = 0.0, size: int | None = None
) -> npt.NDArray[np.float64]: ...
def restore(
    image: npt.ArrayLike, blur: Record | Blur, method: Literal["wiener", "richardson-lucy", "sliding-dct"] = "wiener"
) -> npt.NDArray[np.float32]: ...
def dead_leaves(height: int, width: int, *, seed: int = 0) -> npt.NDArray[np.float64]: ...
def simulate(
    scene: npt.ArrayLike | tuple[int, int],
    length_px: float,
    angle_deg: float,
    *,
    accel_ratio: float = 0.0,
    noise_db: float | None = None,
    seed: int = 0,
    quantize: bool = True,
) -> npt.NDArray[Any]: ...

@final
class Camera:
    def __new__(
        cls,
        width_px: int,
        height_px: int,
        *,
        covariance: npt.ArrayLike | None = None,
        fx_px: float = ...,
        fy_px: float = ...,
        cx_px: float = ...,
        cy_px: float = ...,
        skew_px: float = ...,
        k1: float = ...,
        k2: float = ...,
        p1: float = ...,
        p2: float = ...,
        k3: float = ...,
    ) -> Camera: ...
    @property
    def width_px(self) -> int: ...
    @property
    def height_px(self) -> int: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def stds(self) -> dict[str, float]: ...
    @property
    def covariance(self) -> npt.NDArray[np.float64]: ...
    def project(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]: ...
    def unproject(self, pixels: npt.ArrayLike) -> npt.NDArray[np.float64]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __getnewargs_ex__(self) -> tuple[tuple[int, int], dict[str, Any]]: ...

@final
class Calibration:
    @property
    def camera(self) -> Camera: ...
    @property
    def rms_px(self) -> float: ...
    @property
    def view_rms_px(self) -> list[float]: ...
    @property
    def view_tilt_deg(self) -> list[float]: ...
    @property
    def points(self) -> int: ...

def calibrate(
    board: npt.ArrayLike,
    views: Iterable[npt.ArrayLike],
    width_px: int,
    height_px: int,
    *,
    distortion: Literal[2, 4, 5] = 5,
    skew: bool = False,
) -> Calibration: ...
def find_board(
    image: _Image,
    columns: int,
    rows: int,
    square: float,
    *,
    pitch: float | None = None,
    order: _Order = "rgb",
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
