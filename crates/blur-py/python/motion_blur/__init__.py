"""Direction, length, speed and acceleration from one motion-blurred picture, with their uncertainties.

>>> import motion_blur
>>> picture = motion_blur.simulate((256, 256), 20.0, 30.0, noise_db=40.0, seed=1)
>>> record = motion_blur.estimate(picture, exposure_s=0.01, scale_m_per_px=1e-3)
>>> round(record.length_px), round(record.angle_deg), round(record.speed_m_s)
(20, 30, 2)

Pictures are arrays of NumPy, row 0 at the top. Angles are in degrees, counter-clockwise from +x as seen; lengths in pixels.
A picture alone does not tell a motion from its opposite, so ``angle_deg`` is an axis in [0, 180).
"""

from ._data import Blur, Picture, Record
from ._native import (
    Calibration,
    Camera,
    Meter,
    MotionBlurError,
    calibrate,
    dead_leaves,
    estimate,
    estimate_batch,
    find_board,
    psf,
    read,
    restore,
    simulate,
)

__all__ = [
    "Blur",
    "Calibration",
    "Camera",
    "Meter",
    "MotionBlurError",
    "Picture",
    "Record",
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
