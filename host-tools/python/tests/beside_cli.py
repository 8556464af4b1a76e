"""identify in process beside the command line, on the UR10's series B.

    cargo build --release -p truearm-host
    cargo xtask python
    target/python/bare/bin/python host-tools/python/tests/beside_cli.py

Processor time, least of nine in turns; what the program needs to start and to read the
same file, by `fk`, is taken off its own.
"""

import pathlib
import resource
import subprocess
import tempfile
import time

import truearm

ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = ROOT / "tests/data/ur10-ipa"
PROGRAM = ROOT / "target/release/truearm"
ROUNDS = 9


def spent(words):
    """Processor time of the program, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


robot = truearm.Robot.read(DATA / "robot.toml")
rows = truearm.Measurements.read(DATA / "series-b/measurements.csv", robot)
own, program, reading = [], [], []
with tempfile.TemporaryDirectory() as folder:
    files = [DATA / "robot.toml", DATA / "series-b/measurements.csv"]
    out = pathlib.Path(folder) / "out"
    for _ in range(ROUNDS):
        start = time.process_time()
        found = truearm.identify(robot, rows)
        own.append(time.process_time() - start)
        program.append(spent(["identify", *files, "--out", out]))
        points = pathlib.Path(folder) / "points.csv"
        reading.append(spent(["fk", out / "model.toml", files[1], "--out", points]))
        points.unlink()
told = min(program) - min(reading)
print(f"in process {min(own):.3f} s; the program {min(program):.3f} s, of which {min(reading):.3f} s")
print(f"to start and to read: {min(own) / told:.3f} times as long")
