"""Calibrated URDFs as Pinocchio reads them.

Argument: the folder that `cargo xtask peers` wrote: NAME.urdf, and NAME.txt with joint
values and where truearm has the target, a pose a line.
"""

import pathlib
import sys

import numpy as np
import pinocchio as pin

for path in sorted(pathlib.Path(sys.argv[1]).glob("*.urdf")):
    model = pin.buildModelFromUrdf(str(path))
    data, target = model.createData(), model.getFrameId("target")
    rows = np.loadtxt(path.with_suffix(".txt"))
    worst = 0.0
    for row in rows:
        # A joint without limits is a point of the unit circle there.
        q = []
        for joint, value in zip(list(model.joints)[1:], row):
            q += [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
        pin.forwardKinematics(model, data, np.array(q))
        point = pin.updateFramePlacement(model, data, target).translation
        worst = max(worst, np.abs(point - row[-3:]).max())
    print(f"deviation {path.stem} {worst:.3g} {len(rows)}")
