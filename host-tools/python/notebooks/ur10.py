# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A real UR10, calibrated
#
# 1,495 poses measured with a Leica T-Mac. The first 600 are fitted, the others judge what comes of it.
# `jupytext --to notebook ur10.py` makes a notebook of this file; it runs as a plain script, too.
# Figures need matplotlib and are left out without it.

# %%
import pathlib
import tomllib

import numpy as np
import truearm

try:
    import matplotlib.pyplot as plt
except ImportError:
    plt = None

HERE = pathlib.Path(globals().get("__file__", "ur10.py")).resolve().parent
DATA = HERE.parents[2] / "tests" / "data" / "ur10-ipa"

# %% [markdown]
# ## Read
# Radians and metres from here on; the files have degrees and millimetres.

# %%
robot = truearm.Robot.read(DATA / "robot.toml")
every = truearm.Measurements.read(DATA / "series-b" / "measurements.csv", robot)


def rows(chosen):
    """These rows, in the order in which they were measured."""
    index = np.arange(len(every))[chosen]
    return truearm.Measurements.from_arrays(
        robot, every.joints[chosen], every.measured[chosen], order=index, station=["B"] * len(index)
    )


fitted, held_out = rows(slice(0, 600)), rows(slice(600, None))
print(robot.name, len(fitted), "rows to fit,", len(held_out), "held out")

# %% [markdown]
# ## Check
# Gross mistakes first: a joint that counts the other way is no error of a millimetre.

# %%
checked = truearm.check(robot, fitted)
print(checked["verdict"])
assert checked["verdict"] == "sound"

# %% [markdown]
# ## Diagnose
# What geometry does not explain, named; as the last line of a cell `found` is a table.

# %%
found = truearm.diagnose(robot, fitted, holdout=held_out)
print(found)
assert found.verdict == "explained"

# %% [markdown]
# ## The gap
# From the drawing to the final model. The held-out rows go where the fitted ones seldom went: they keep more.

# %%
gap = found.report["gap"]
models = [row["model"] for row in gap]
figures = {
    "fitted": [row["train_rms_mm"] for row in gap],
    "cross-validated": [row["cross_validated_rms_mm"] or np.nan for row in gap],
    "held out": [row["holdout_rms_mm"] for row in gap],
}
for name, values in figures.items():
    print(f"{name:16}", "  ".join(f"{value:.4f}" for value in values), "mm RMS")
assert figures["held out"][-1] < 0.25 * figures["held out"][0]

if plt:
    for name, values in figures.items():
        plt.semilogy(models, values, "o-", label=name)
    plt.axhline(found.report["noise_floor_mm"], linestyle="--", color="grey", label="noise as stated")
    plt.ylabel("RMS error, mm")
    plt.xticks(rotation=20)
    plt.legend()
    plt.show()

# %% [markdown]
# ## The curves
# Joints 1 to 5 err by a smooth curve each. The model has it as nodes of a periodic cubic B-spline over a turn.

# %%


def curve_at(nodes, q):
    """A periodic cubic B-spline over a turn, at q, rad."""
    below, x = np.divmod(np.asarray(q) / (2 * np.pi) * len(nodes), 1.0)
    a, b, c, d = (nodes[(below.astype(int) + k) % len(nodes)] for k in (-1, 0, 1, 2))
    y = 1.0 - x
    return (a * y**3 + b * (4 - 6 * x**2 + 3 * x**3) + c * (4 - 6 * y**2 + 3 * y**3) + d * x**3) / 6


curves = {
    curve["joint"]: np.array(curve["nodes_rad"])
    for curve in tomllib.loads(found.model.to_toml())["curves"]
}
for joint, nodes in curves.items():
    q = fitted.joints[:, joint - 1]
    rms = np.std(curve_at(nodes, q)) * 1e3
    print(f"joint {joint}: {rms:.2f} mrad RMS over {np.degrees(np.ptp(q)):.0f} degrees")
    assert 0.05 < rms < 1.0
    if plt:
        inside = np.linspace(q.min(), q.max(), 600)
        plt.plot(np.degrees(inside), curve_at(nodes, inside) * 1e3, label=f"joint {joint}")
if plt:
    plt.xlabel("joint, degrees")
    plt.ylabel("error, mrad")
    plt.legend()
    plt.show()

# %% [markdown]
# ## Forward kinematics on held-out rows
# Where the tracker should have seen the target, and where it did. The median: some rows are gross errors.

# %%
seen = found.model.forward(held_out.joints, station="B")[:, :3, 3]
missed = np.linalg.norm(seen - held_out.measured, axis=1) * 1e3
drawn = found.model.forward(held_out.joints, station="B", nominal=True)[:, :3, 3]
before = np.linalg.norm(drawn - held_out.measured, axis=1) * 1e3
print(f"median {np.median(before):.3f} mm by the drawing, {np.median(missed):.3f} mm by the model")
assert np.median(missed) < 0.25 * np.median(before)

if plt:
    plt.hist([before, missed], bins=np.linspace(0.0, 2.5, 60), label=["drawing", "model"])
    plt.xlabel("error, mm")
    plt.ylabel("rows")
    plt.legend()
    plt.show()
