"""Identify an arm from files on many machines, with Spark.

    spark-submit [--master spark://host:7077] parts_spark.py start/model.toml identified.toml part1.csv ...

start/model.toml is of `truearm identify` of some of the rows; the workers must see the files
and have the package. Without a master: as many local workers as there are cores.
"""

import os
import sys

import truearm
from pyspark.sql import SparkSession


def add(file, text):
    state = truearm.Model.parse(text)
    return truearm.accumulate(state, truearm.Measurements.read(file, state.robot))


def merge(a, b):
    return truearm.merge([a, b])


if __name__ == "__main__":
    start, out, *files = sys.argv[1:]
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    session = SparkSession.builder.appName("truearm").getOrCreate()
    parts = session.sparkContext.parallelize(files, len(files))
    state, report = truearm.Model.read(start), {"settled": False}
    while not report["settled"] and report.get("stage", 0) < 30:
        text = state.to_toml()
        sums = parts.map(lambda file, text=text: add(file, text)).reduce(merge)
        state, report = truearm.step(state, sums)
        print(report["stage"], report["rms_mm"], report["largest_step_tolerances"])
    session.stop()
    state.save(out)
