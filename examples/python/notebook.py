# %% [markdown]
# # One blurred picture, measured and undone
#
# Cells of a notebook (VS Code, Spyder, Jupyter with jupytext), or a plain program:
# `python examples/python/notebook.py [FOLDER]` writes its figures into FOLDER.

# %%
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import motion_blur

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "figures")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# A scene of known truth: it moves over 24.6 pixels, 30 degrees up, in 20 ms; the noise is 35 dB below full scale.

# %%
LENGTH_PX, ANGLE_DEG, NOISE_DB = 24.6, 30.0, 35.0
scene = motion_blur.dead_leaves(420, 560, seed=7)
picture = motion_blur.simulate(scene, LENGTH_PX, ANGLE_DEG, noise_db=NOISE_DB, seed=7)

# %% [markdown]
# The measurement. Exposure and scale turn pixels into a speed; their uncertainties go into its own.

# %%
record = motion_blur.estimate(
    picture, exposure_s=0.020, exposure_std_s=0.0001, scale_m_per_px=0.7789e-3, scale_std_m_per_px=0.8e-6
)
print(f"angle  {record.angle_deg:.3f} +- {record.angle_std_deg:.3f} deg   (truth {ANGLE_DEG})")
print(f"length {record.length_px:.3f} +- {record.length_std_px:.3f} px    (truth {LENGTH_PX})")
print(f"speed  {record.speed_m_s:.4f} +- {record.speed_std_m_s:.4f} m/s   (truth {LENGTH_PX * 0.7789e-3 / 0.020:.4f})")
print(f"status {record.status}")

# %% [markdown]
# The blur kernel that was found, and the picture without it.

# %%
kernel = motion_blur.psf(record.length_px, record.angle_deg, size=31)
restored = motion_blur.restore(picture, record)
top, left = [(big - small) // 2 for big, small in zip(scene.shape, picture.shape, strict=True)]
sharp = scene[top : top + picture.shape[0], left : left + picture.shape[1]]

figure, axes = plt.subplots(2, 2, figsize=(10, 8), layout="constrained")
for axis, pixels, title in [
    (axes[0, 0], picture, f"blurred: {record.length_px:.2f} px along {record.angle_deg:.2f} deg"),
    (axes[0, 1], restored, "restored with what was measured"),
    (axes[1, 0], sharp, "the scene as it was"),
]:
    axis.imshow(pixels, cmap="gray", vmin=0, vmax=255)
    axis.set_title(title)
    axis.axis("off")
axes[1, 1].imshow(kernel, cmap="magma")
axes[1, 1].set_title("kernel (share of the exposure in each pixel)")
figure.savefig(folder / "restored.png", dpi=80)

# %% [markdown]
# Are the uncertainties honest? Many pictures of other scenes and other noise: at least 68 % of the errors should lie within one
# standard uncertainty and 95 % within two. More is on the safe side.

# %%
pictures = [
    motion_blur.simulate((200, 200), LENGTH_PX, ANGLE_DEG, noise_db=NOISE_DB, seed=seed) for seed in range(200)
]
results = motion_blur.estimate_batch(pictures)
records = [result for result in results if isinstance(result, motion_blur.Record) and result.status == "ok"]
errors = {
    "length": np.array([(r.length_px - LENGTH_PX) / (r.length_std_px or np.nan) for r in records]),
    "angle": np.array([(r.angle_deg - ANGLE_DEG) / (r.angle_std_deg or np.nan) for r in records]),
}
figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
grid = np.linspace(-4, 4, 200)
for axis, (name, z) in zip(axes, errors.items(), strict=True):
    one, two = (np.abs(z) < 1).mean(), (np.abs(z) < 2).mean()
    print(f"{name}: {one:.1%} within one standard uncertainty, {two:.1%} within two ({len(records)} pictures)")
    axis.hist(z, bins=np.arange(-4, 4.25, 0.5).tolist(), density=True, color="0.7")
    axis.plot(grid, np.exp(-(grid**2) / 2) / np.sqrt(2 * np.pi), color="C3", label="normal distribution")
    axis.set_title(f"{name}: {two:.1%} within two standard uncertainties")
    axis.set_xlabel("error / standard uncertainty")
    axis.legend()
figure.savefig(folder / "coverage.png", dpi=80)
print(f"figures: {folder / 'restored.png'}, {folder / 'coverage.png'}")
