"""Identify an arm from files on many machines, with Dask.

    python parts_dask.py start/model.toml identified.toml part1.csv part2.csv ...

start/model.toml is of `truearm identify` of some of the rows. With DASK_SCHEDULER set
(tcp://host:8786) the workers of that cluster do it, which must see the files and have the
package; else as many local ones as there are cores.
"""

import os
import sys

import dask.bag
import truearm
from dask.distributed import Client


def add(file, state):
    return truearm.accumulate(state, truearm.Measurements.read(file, state.robot))


def merge(a, b):
    return truearm.merge([a, b])


if __name__ == "__main__":
    start, out, *files = sys.argv[1:]
    with Client(os.environ.get("DASK_SCHEDULER")):
        state, report = truearm.Model.read(start), {"settled": False}
        while not report["settled"] and report.get("stage", 0) < 30:
            parts = dask.bag.from_sequence(files, npartitions=len(files)).map(add, state)
            state, report = truearm.step(state, parts.fold(merge).compute())
            print(report["stage"], report["rms_mm"], report["largest_step_tolerances"])
    state.save(out)
