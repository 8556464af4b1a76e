"""truearm: identify, diagnose, plan, verify and compensate robot arms.

Radians and metres here; degrees and millimetres in files.
"""

from __future__ import annotations

import html
import json
from typing import Any

from . import _truearm
from ._truearm import (
    Compensated,
    Measurements,
    Model,
    Robot,
    TruearmError,
    accumulate,
    merge,
)

__all__ = [
    "Compensated",
    "Measurements",
    "Model",
    "Result",
    "Robot",
    "TruearmError",
    "accumulate",
    "check",
    "diagnose",
    "evaluate",
    "identify",
    "merge",
    "plan",
    "step",
    "verify",
]


class Result:
    """A model and its report, a dictionary as the program writes it to report.json."""

    def __init__(self, found: Any) -> None:
        self.model: Model = found.model
        self.report: dict[str, Any] = json.loads(found.json)

    @property
    def verdict(self) -> str | None:
        """`clean`, `explained` or `unexplained`; none of an identification."""
        return self.report.get("verdict")

    @property
    def effects(self) -> list[dict[str, Any]]:
        """What was named, most important first."""
        return self.report.get("effects", [])

    def _gap(self) -> list[tuple[str, float, float | None]]:
        if "gap" in self.report:
            rows = self.report["gap"]
            return [(r["model"], r["train_rms_mm"], r["cross_validated_rms_mm"]) for r in rows]
        nominal, identified = self.report["nominal"], self.report["identified"]
        held_out = self.report["cross_validated"]
        rms = lambda stats: stats and stats["rms_mm"]  # noqa: E731
        return [("nominal", rms(nominal), None), ("geometry", rms(identified), rms(held_out))]

    def __repr__(self) -> str:
        lines = [f"{self.verdict}" if self.verdict else "identified"]
        for effect in self.effects:
            joints = ", ".join(map(str, effect["joints"]))
            where = f" of joint {joints}" if joints else ""
            lines.append(f"  {effect['name']}{where}: probability {effect['probability']:.2f}")
        for model, fitted, held_out in self._gap():
            beside = "" if held_out is None else f", held out {held_out:.4f}"
            lines.append(f"  {model}: {fitted:.4f} mm RMS{beside}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        cell = lambda x: "" if x is None else f"{x:.4f}"  # noqa: E731
        rows = "".join(
            f"<tr><td>{html.escape(m)}</td><td>{cell(f)}</td><td>{cell(h)}</td></tr>"
            for m, f, h in self._gap()
        )
        named = "".join(
            f"<li>{html.escape(e['name'])} {html.escape(str(e['joints']))}, "
            f"probability {e['probability']:.2f}</li>"
            for e in self.effects
        )
        robot = html.escape(str(self.report.get("robot", "")))
        return (
            f"<b>{robot}: {html.escape(self.verdict or 'identified')}</b><ul>{named}</ul>"
            f"<table><tr><th>RMS, mm</th><th>fitted</th><th>held out</th></tr>{rows}</table>"
        )


def identify(robot: Robot, data: Measurements, *, allow_few_poses: bool = False) -> Result:
    """Identifies the geometry of an arm."""
    return Result(_truearm.identify(robot, data, allow_few_poses))


def diagnose(
    robot: Robot,
    data: Measurements,
    *,
    holdout: Measurements | None = None,
    most_terms: int | None = None,
    highest_order: float | None = None,
    allow_few_poses: bool = False,
) -> Result:
    """Finds what geometry does not explain, names it, and shows the gap shrink."""
    found = _truearm.diagnose(robot, data, holdout, most_terms, highest_order, allow_few_poses)
    return Result(found)


def step(state: Model, sums: bytes) -> tuple[Model, dict[str, Any]]:
    """The next state of an identification by parts, and what is known of this one. `sums` is
    `merge` of what `accumulate` says of every part at `state`; settled is `report["settled"]`."""
    found = _truearm.step(state, sums)
    return found.model, json.loads(found.json)


def check(robot: Robot, data: Measurements) -> dict[str, Any]:
    """Gross mistakes in the files, found and named."""
    return json.loads(_truearm.check(robot, data))


def evaluate(
    model: Model, data: Measurements, *, reregister: str | None = None
) -> dict[str, Any]:
    """Scores a model on other measurements; `reregister` is `base` or `base+tool`."""
    return json.loads(_truearm.evaluate(model, data, reregister))


def verify(
    model: Model,
    path: str,
    *,
    reregister: bool = False,
    tolerance_mm: float | None = None,
    tolerance_deg: float | None = None,
) -> dict[str, Any]:
    """Commanded against measured, after flashing."""
    return json.loads(_truearm.verify(model, path, reregister, tolerance_mm, tolerance_deg))


def plan(
    robot: Robot,
    poses: int = 20,
    *,
    candidates: int = 2000,
    target_um: float | None = None,
    seed: int = 1,
    kind: str = "point",
) -> tuple[Any, dict[str, Any]]:
    """Poses to measure (n x joints, rad or m) and what they will tell; `kind` is what the
    instrument measures at each: `point`, or `pose`, its orientation as well."""
    found, report = _truearm.plan(robot, poses, candidates, target_um, seed, kind)
    return found, json.loads(report)
