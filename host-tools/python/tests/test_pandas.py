"""Tables of pandas, in and out; run by `cargo xtask python` where pandas is installed."""

import pathlib
import unittest

import numpy as np
import pandas as pd
import truearm

CASE = pathlib.Path(__file__).resolve().parents[3] / "tests/data/hidden-effects/cases/case_009"
JOINTS = [f"q{k}_deg" for k in range(1, 7)]
POINTS = ["x_mm", "y_mm", "z_mm"]


class Pandas(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = truearm.Robot.read(CASE / "robot.toml")
        cls.file = truearm.Measurements.read(CASE / "measurements.csv", cls.robot)
        cls.table = pd.read_csv(CASE / "measurements.csv")

    def given(self, table):
        others = {c: table[c] for c in table.columns if c not in JOINTS + POINTS}
        joints, points = np.radians(table[JOINTS]), table[POINTS] / 1e3
        return truearm.Measurements.from_arrays(self.robot, joints, points, **others)

    def test_a_table_is_what_its_file_is(self):
        data = self.given(self.table)
        np.testing.assert_allclose(data.joints, self.file.joints, atol=1e-14)
        np.testing.assert_allclose(data.measured, self.file.measured, atol=1e-14)
        own, read = (truearm.identify(self.robot, d).report for d in (data, self.file))
        self.assertAlmostEqual(own["identified"]["rms_mm"], read["identified"]["rms_mm"], delta=1e-9)

    def test_what_is_missing_is_an_empty_cell(self):
        for nothing in (float("nan"), None, pd.NA):
            table = self.table.assign(temperature_c=pd.Series([20.5, nothing] * len(self.table)))
            self.assertEqual(len(self.given(table)), len(self.table))
        with self.assertRaises(truearm.TruearmError):
            self.given(self.table.assign(temperature_c="warm"))

    def test_joints_come_as_they_are(self):
        degrees = self.table[JOINTS].round().astype(int)
        for joints in (degrees, degrees.to_numpy(), degrees.to_numpy().tolist()):
            poses = self.robot.forward(joints)
            np.testing.assert_array_equal(poses, self.robot.forward(degrees.to_numpy(float)))
        told = truearm.identify(self.robot, self.file).model.compensate(np.radians(degrees))
        after = pd.DataFrame(told.joints, columns=JOINTS, index=self.table.index)
        self.assertEqual(after.shape, self.table[JOINTS].shape)


if __name__ == "__main__":
    unittest.main()
