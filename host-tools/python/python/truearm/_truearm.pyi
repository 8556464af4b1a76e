from os import PathLike
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

class TruearmError(ValueError):
    help: str

class Robot:
    @staticmethod
    def read(path: str | PathLike[str]) -> Robot: ...
    @staticmethod
    def parse(text: str) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def warnings(self) -> list[str]: ...
    def forward(self, joint_values: Array) -> Array: ...
    def jacobian(self, joint_values: Array) -> Array: ...

class Measurements:
    @staticmethod
    def read(path: str | PathLike[str], robot: Robot) -> Measurements: ...
    @staticmethod
    def from_arrays(robot: Robot, joints: Array, points: Array, **columns: Sequence[Any]) -> Measurements: ...
    @property
    def joints(self) -> Array: ...
    @property
    def measured(self) -> Array: ...
    @property
    def warnings(self) -> list[str]: ...
    def __len__(self) -> int: ...

class Model:
    @staticmethod
    def read(path: str | PathLike[str]) -> Model: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def to_toml(self) -> str: ...
    def pack(self, sequence: int | None = None, covariance: bool = False) -> bytes: ...
    def forward(
        self,
        joint_values: Array,
        nominal: bool = False,
        station: str | None = None,
        marker: str | None = None,
    ) -> Array: ...
    def jacobian(self, joint_values: Array) -> Array: ...
    def compensate(
        self,
        joint_values: Array,
        extrapolate: bool = False,
        single: bool = False,
        task: str | None = None,
        payload: float | Sequence[float] | None = None,
        temperature: float | Sequence[float] | None = None,
    ) -> Compensated: ...

class Compensated:
    @property
    def joints(self) -> Array: ...
    @property
    def left(self) -> Array: ...
    @property
    def covered(self) -> NDArray[np.bool_]: ...
    @property
    def clamped(self) -> NDArray[np.bool_]: ...

class Found:
    model: Model
    json: str

def identify(robot: Robot, data: Measurements, allow_few_poses: bool = False) -> Found: ...
def diagnose(
    robot: Robot,
    data: Measurements,
    holdout: Measurements | None = None,
    most_terms: int | None = None,
    highest_order: float | None = None,
    allow_few_poses: bool = False,
) -> Found: ...
def check(robot: Robot, data: Measurements) -> str: ...
def evaluate(model: Model, data: Measurements, reregister: str | None = None) -> str: ...
def verify(
    model: Model,
    path: str,
    reregister: bool = False,
    tolerance_mm: float | None = None,
    tolerance_deg: float | None = None,
) -> str: ...
def plan(
    robot: Robot,
    poses: int = 20,
    candidates: int = 2000,
    target_um: float | None = None,
    seed: int = 1,
    kind: str = "point",
) -> tuple[Array, str]: ...
