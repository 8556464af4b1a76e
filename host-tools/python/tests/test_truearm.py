"""The package on shipped data; run by `cargo xtask python` in a bare environment."""

import contextlib
import io
import os
import pathlib
import pickle
import shutil
import tempfile
import time
import tomllib
import unittest

import numpy as np
import truearm

DATA = pathlib.Path(__file__).resolve().parents[3] / "tests" / "data"
CASE = DATA / "hidden-effects" / "cases" / "case_009"


def numpy_forward(robot_file, q):
    """The same arm by 4x4 matrices, vectorised over poses."""
    text = tomllib.loads(robot_file.read_text())
    n = len(q)

    def eye():
        return np.tile(np.eye(4), (n, 1, 1))

    def turn(axis, angle):
        i, j = [(1, 2), (2, 0), (0, 1)][axis]
        m = eye()
        c, s = np.cos(angle), np.sin(angle)
        m[:, i, i], m[:, j, j], m[:, i, j], m[:, j, i] = c, c, -s, s
        return m

    def shift(axis, by):
        m = eye()
        m[:, axis, 3] = by
        return m

    a = eye()
    for k, joint in enumerate(text["joints"]):
        rad = lambda key: np.radians(joint.get(key, 0.0))  # noqa: E731
        a = a @ turn(0, rad("alpha_deg")) @ shift(0, joint.get("a_mm", 0.0) / 1e3)
        a = a @ turn(2, rad("theta_offset_deg") + q[:, k]) @ shift(2, joint.get("d_mm", 0.0) / 1e3)
        a = a @ turn(1, rad("beta_deg"))
    tool = np.array(text.get("tool", {}).get("xyz_mm", [0.0, 0.0, 0.0])) / 1e3
    a[:, :3, 3] += a[:, :3, :3] @ tool
    return a


class Truearm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = truearm.Robot.read(CASE / "robot.toml")
        cls.data = truearm.Measurements.read(CASE / "measurements.csv", cls.robot)
        cls.found = truearm.diagnose(cls.robot, cls.data)

    def test_a_verdict_in_a_few_lines(self):
        self.assertEqual(self.found.verdict, "explained")
        self.assertEqual([e["name"] for e in self.found.effects], ["thermal-expansion"])
        self.assertIn("thermal-expansion", repr(self.found))
        self.assertIn("<table>", self.found._repr_html_())

    def test_identify_has_figures(self):
        found = truearm.identify(self.robot, self.data)
        self.assertLess(found.report["identified"]["rms_mm"], found.report["nominal"]["rms_mm"])

    def test_arrays_say_what_files_say(self):
        again = truearm.Measurements.from_arrays(
            self.robot, self.data.joints, self.data.measured, order=list(range(len(self.data)))
        )
        self.assertEqual(len(again), len(self.data))
        np.testing.assert_allclose(again.joints, self.data.joints, atol=1e-14)
        np.testing.assert_allclose(again.measured, self.data.measured, atol=1e-14)

    def test_forward_is_the_arm_and_faster_than_numpy(self):
        rng = np.random.default_rng(1)
        q = rng.uniform(-2.5, 2.5, (100_000, self.robot.joints))
        own_s, their_s = [], []
        # The quickest of each, one after the other: what else runs disturbs both.
        for _ in range(5):
            start = time.perf_counter()
            own = self.robot.forward(q)
            middle = time.perf_counter()
            theirs = numpy_forward(CASE / "robot.toml", q)
            own_s.append(middle - start)
            their_s.append(time.perf_counter() - middle)
        np.testing.assert_allclose(own, theirs, atol=1e-9)
        ratio = min(their_s) / min(own_s)
        print(f"forward kinematics of 100,000 poses: {ratio:.1f} times as fast as numpy")

    def test_the_jacobian_is_the_derivative(self):
        q = self.data.joints[:5]
        jacobian = self.robot.jacobian(q)
        for k in range(q.shape[1]):
            step = np.zeros(q.shape[1])
            step[k] = 1e-6
            ahead, behind = self.robot.forward(q + step), self.robot.forward(q - step)
            slope = (ahead[:, :3, 3] - behind[:, :3, 3]) / 2e-6
            np.testing.assert_allclose(jacobian[:, :3, k], slope, atol=1e-8)

    def test_compensated_joints_meet_the_nominal_points(self):
        model, q = self.found.model, self.data.joints[:50]
        told = model.compensate(q)
        better, left = told.joints, told.left
        # Rows that were fitted are covered, to the last bit.
        self.assertTrue(told.covered.all(), told)
        self.assertTrue(model.compensate(self.data.joints).covered.all())
        self.assertFalse(told.clamped.any(), told)
        wanted = model.forward(q, nominal=True)[:, :3, 3]
        missed = np.linalg.norm(model.forward(better)[:, :3, 3] - wanted, axis=1)
        np.testing.assert_allclose(missed, left, atol=1e-9)
        before = np.linalg.norm(model.forward(q)[:, :3, 3] - wanted, axis=1)
        self.assertLess(missed.max(), 0.05 * before.max())

    def test_state_and_task_are_taken(self):
        model, q = self.found.model, self.data.joints[:20]
        rest = model.compensate(q).joints
        # Thermal expansion is what this arm has.
        warm = model.compensate(q, temperature=40.0)
        self.assertGreater(np.abs(warm.joints - rest).max(), 1e-6)
        each = model.compensate(q, temperature=[40.0] * len(q), payload=np.zeros(len(q)))
        np.testing.assert_array_equal(each.joints, warm.joints)
        position = model.compensate(q, task="position").joints
        np.testing.assert_array_equal(position, rest)
        for wrong in [{"task": "somewhere"}, {"temperature": [20.0]}, {"task": "pose"}]:
            with self.assertRaises(truearm.TruearmError):
                model.compensate(q, **wrong)
        outside = q.copy()
        outside[0, 0] = self.data.joints[:, 0].max() + 0.01
        told = model.compensate(outside)
        self.assertEqual(list(told.covered), [False] + [True] * (len(q) - 1))
        np.testing.assert_allclose(told.joints[0], outside[0], rtol=1e-15)

    def test_parts_are_the_whole(self):
        start = truearm.identify(self.robot, self.data).model
        rows = (CASE / "measurements.csv").read_text().splitlines()
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder) / f"{k}.csv" for k in range(3)]
            for k, file in enumerate(files):
                file.write_text("\n".join([rows[0], *rows[1 + k :: 3]]) + "\n")
            parts = [truearm.Measurements.read(file, start.robot) for file in files]
        whole, split = start, start
        for _ in range(9):
            whole, report = truearm.step(whole, truearm.accumulate(whole, self.data))
            copy = pickle.loads(pickle.dumps(split))
            sums = truearm.merge([truearm.accumulate(copy, part) for part in parts])
            split, _ = truearm.step(split, sums)
        self.assertTrue(report["settled"], report)
        a, b = whole.forward(self.data.joints), split.forward(self.data.joints)
        np.testing.assert_allclose(a, b, atol=1e-12)
        with self.assertRaises(truearm.TruearmError):
            truearm.step(start, sums)

    def test_the_readme_runs(self):
        readme = pathlib.Path(__file__).resolve().parents[1] / "README.md"
        blocks = readme.read_text().split("```python\n")[1:]
        self.assertEqual(len(blocks), 1)
        code = blocks[0].split("```")[0]
        here, said = os.getcwd(), io.StringIO()
        with tempfile.TemporaryDirectory() as folder:
            for name in ["robot.toml", "measurements.csv"]:
                shutil.copy(CASE / name, folder)
            os.chdir(folder)
            try:
                names = {}
                with contextlib.redirect_stdout(said):
                    exec(compile(code, str(readme), "exec"), names)
                self.assertGreater(pathlib.Path("params.bin").stat().st_size, 500)
            finally:
                os.chdir(here)
        lines = said.getvalue().splitlines()
        self.assertEqual(lines[0], "explained")
        self.assertIn("thermal-expansion", lines[1])
        self.assertLess(float(lines[-1]), 1.0)
        self.assertEqual(names["better"].shape, self.data.joints.shape)

    def test_a_station_sees_what_it_measured(self):
        seen = self.found.model.forward(self.data.joints, station="")[:, :3, 3]
        missed = np.linalg.norm(seen - self.data.measured, axis=1)
        # Its temperatures are not told, so that growth is in it.
        self.assertLess(np.median(missed), 5e-4)
        with self.assertRaises(truearm.TruearmError):
            self.found.model.forward(self.data.joints, station="elsewhere")

    def test_what_is_packed_and_saved_is_read(self):
        self.assertGreater(len(self.found.model.pack(sequence=1)), 500)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "model.toml"
            self.found.model.save(path)
            again = truearm.Model.read(path)
        q = self.data.joints[:5]
        np.testing.assert_allclose(again.forward(q), self.found.model.forward(q), atol=1e-12)

    def test_evaluate_check_and_plan(self):
        holdout = truearm.Measurements.read(CASE / "holdout.csv", self.robot)
        scored = truearm.evaluate(self.found.model, holdout)
        rms = scored["validation"]["rms_mm"]
        self.assertTrue(0.0 < rms < 1.0, rms)
        self.assertEqual(truearm.check(self.robot, self.data)["verdict"], "sound")
        poses, report = truearm.plan(self.robot, 13, candidates=300)
        self.assertEqual(poses.shape, (13, self.robot.joints))
        self.assertEqual(report["command"], "plan")

    def test_plans_for_what_the_instrument_measures(self):
        text = (CASE / "robot.toml").read_text()
        robot = truearm.Robot.parse("measurement_sigma_deg = 0.005\n" + text)
        reports = {}
        for kind in ["point", "pose"]:
            poses, reports[kind] = truearm.plan(robot, 13, candidates=300, kind=kind)
            self.assertEqual((poses.shape, reports[kind]["kind"]), ((13, robot.joints), kind))
        # Only orientations tell how the last frame is turned.
        point, pose = (reports[kind]["parameters"] for kind in ["point", "pose"])
        self.assertGreater(pose, point)
        # From nowhere no distance is measured.
        for kind, help in [("nothing", "measurements.csv"), ("distance", "[[anchors]]")]:
            with self.assertRaises(truearm.TruearmError) as caught:
                truearm.plan(robot, 13, candidates=300, kind=kind)
            self.assertIn(help, caught.exception.help)

    def test_errors_say_what_to_do(self):
        with self.assertRaises(truearm.TruearmError) as caught:
            truearm.Robot.read("nothing.toml")
        self.assertIn("nothing.toml", str(caught.exception))
        with self.assertRaises(truearm.TruearmError) as caught:
            self.robot.forward(np.zeros((3, 2)))
        self.assertIn("joints", caught.exception.help)
        with self.assertRaises(ValueError):
            self.robot.forward(np.full((1, self.robot.joints), np.nan))
        with self.assertRaises(truearm.TruearmError) as caught:
            truearm.Measurements.from_arrays(
                self.robot, self.data.joints, self.data.measured, order=[1, 2]
            )
        self.assertIn("order", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
