"""The plain data of the package: frozen, comparable, ready for pickle."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """All that one picture tells, in plain numbers; what was not computed is None.

    Names and order are those of ``estimate --json``. The same pixels under the same options give the same record, bit for bit,
    in Rust, on the command line and here. ``*_std_*`` are standard uncertainties.
    """

    width: int
    """Columns of the picture."""
    height: int
    """Rows of the picture."""
    method: str
    """The method."""
    linearized: bool
    """Whether the sRGB tone curve was undone first."""
    tracked: bool
    """Whether the fit started from the result of the frame before."""
    angle_deg: float
    """Axis of the motion in degrees, in [0, 180), counter-clockwise from +x as seen."""
    angle_std_deg: float | None = None
    direction_deg: float | None = None
    """Where the content moved in degrees, in [0, 360), when that is known."""
    length_px: float
    """Blur length in pixels."""
    length_std_px: float | None = None
    correlation: float | None = None
    """Correlation coefficient of angle and length."""
    status: str
    """How far to trust the result: ``ok``, ``low_confidence`` or ``no_motion_blur``."""
    reason: str | None = None
    """Why it is not ``ok``."""
    accel_ratio: float | None = None
    """a T / (2 v), without its sign unless the method knows it."""
    accel_ratio_std: float | None = None
    accel_ratio_limit: float | None = None
    """The least ratio that counts as detected."""
    accel_detected: bool | None = None
    accel_m_s2: float | None = None
    """Acceleration in metres per second squared."""
    accel_std_m_s2: float | None = None
    gain_per_bin: float | None = None
    """Gain in log-likelihood over no blur, for each bin of signal."""
    rival_share: float | None = None
    """Evidence for the best other blur, relative to the one found."""
    incoherent_share: float | None = None
    """Share of the light that does not follow the motion."""
    misfit: float | None = None
    """Mean squared standardised residual of the spectrum."""
    band_cycles_per_px: float | None = None
    """Highest frequency that the result rests on."""
    exposure_s: float | None = None
    """Exposure time in seconds."""
    scale_m_per_px: float | None = None
    """Metres in the scene for each pixel of the blur."""
    scale_std_m_per_px: float | None = None
    speed_m_s: float | None = None
    """Mean speed during the exposure in metres per second."""
    speed_std_m_s: float | None = None
    speed_expanded_m_s: float | None = None
    """Expanded uncertainty of the speed: ``coverage_k`` times the standard one."""
    coverage_k: float | None = None
    angular_rate_rad_s: float | None = None
    """How fast the camera turned in radians per second."""
    angular_rate_std_rad_s: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """The fields that were computed, in order: one line of ``estimate --json``."""
        named = ((field.name, getattr(self, field.name)) for field in fields(self))
        return {name: value for name, value in named if value is not None}


@dataclass(frozen=True, slots=True)
class Blur:
    """A motion over ``length_px`` pixels along ``angle_deg``, to be undone by ``restore``."""

    length_px: float
    angle_deg: float
    accel_ratio: float = 0.0
    """a T / (2 v) in -1 to 1, positive when the content speeds up along ``angle_deg``."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture that was read from a file, upright: what ``estimate`` takes in place of an array."""

    luma: npt.NDArray[np.float32]
    """Grey values, rows x columns. Integer samples are on the scale 0 to 255 whatever their depth."""
    linearized: bool
    """Whether the sRGB tone curve was undone."""
    exposure_s: float | None = None
    """Exposure time in seconds that the camera wrote."""
    note: str | None = None
    """What is wrong with what the camera wrote."""

    def __repr__(self) -> str:
        height, width = self.luma.shape
        return f"Picture({width}x{height}, linearized={self.linearized}, exposure_s={self.exposure_s})"
