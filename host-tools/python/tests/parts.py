"""One run, 64 parts, Dask and Spark: the same arm? Run by `cargo xtask study parts`.

    python parts.py [dask] [spark]
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib

import truearm

HERE = pathlib.Path(__file__).resolve()
DATA = HERE.parents[3] / "tests" / "data" / "ur10-ipa"
EXAMPLES = HERE.parents[1] / "examples"
PARTS = 64
# Of a tolerance, 1 mm or 1 mrad.
SAME = 1e-10


def settled(state, datas):
    while True:
        parts = [truearm.accumulate(state, data) for data in datas]
        state, report = truearm.step(state, truearm.merge(parts))
        if report["settled"]:
            return state, report


def corrections(model):
    for joint in tomllib.loads(model.to_toml())["corrections"]:
        for key, value in joint.items():
            if isinstance(value, list):
                continue
            if key.endswith("_deg"):
                yield math.radians(value) / 1e-3
            elif key.endswith("_mm"):
                yield value


def main(engines):
    robot = truearm.Robot.read(DATA / "robot.toml")
    header, *rows = (DATA / "series-b" / "measurements.csv").read_text().splitlines()
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)

        def write(name, some):
            (folder / name).write_text("\n".join([header, *some]) + "\n")
            return str(folder / name)

        edge = lambda k: k * len(rows) // PARTS  # noqa: E731
        parts = [rows[edge(k) : edge(k + 1)] for k in range(PARTS)]
        files = [write(f"part-{k:02}.csv", part) for k, part in enumerate(parts)]
        read = lambda file: truearm.Measurements.read(file, robot)  # noqa: E731
        start = truearm.identify(robot, read(write("some.csv", rows[::8]))).model
        start.save(folder / "start.toml")
        begin = time.perf_counter()
        one, report = settled(start, [read(write("all.csv", rows))])
        print(f"one run: {report['stage']} rounds, {report['rms_mm']:.6f} mm, "
              f"held out {report['cross_validated_rms_mm']:.6f} mm, "
              f"{time.perf_counter() - begin:.1f} s")
        worst = 0.0

        def compared(name, model, seconds):
            nonlocal worst
            apart = max(abs(a - b) for a, b in zip(corrections(one), corrections(model)))
            worst = max(worst, apart)
            print(f"{name}: {apart:.1e} tolerances from one run, {seconds:.1f} s")

        begin = time.perf_counter()
        many, _ = settled(start, [read(file) for file in files])
        compared(f"{len(files)} parts", many, time.perf_counter() - begin)
        for engine in engines:
            out = folder / f"{engine}.toml"
            script = [sys.executable, str(EXAMPLES / f"parts_{engine}.py")]
            begin = time.perf_counter()
            subprocess.run(
                [*script, str(folder / "start.toml"), str(out), *files],
                check=True,
                capture_output=True,
            )
            compared(engine, truearm.Model.read(out), time.perf_counter() - begin)
    sys.exit(0 if worst < SAME else f"{worst:.1e} is more than {SAME} tolerances")


if __name__ == "__main__":
    main(sys.argv[1:])
