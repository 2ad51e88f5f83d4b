"""The extension module: thin bindings of the library. Nothing here is meant to be used directly."""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

from .errors import InputError, SolveError, WhipcordError

_Array = npt.NDArray[np.float64]
# Code, message, help, and path, line and column of a warning.
_Notice = tuple[str, str, str, tuple[str, int, int] | None]

__all__ = [
    "VERSION",
    "Board",
    "Camera",
    "Controller",
    "Derivatives",
    "Fitted",
    "Model",
    "Motions",
    "Outcomes",
    "Photo",
    "Scored",
    "Seen",
    "Setup",
    "Simulation",
    "SimulationState",
    "Solution",
    "benchmark",
    "calibrate",
    "calibrate_two",
    "derivatives",
    "distances",
    "examples",
    "export",
    "fit",
    "follow",
    "in_space",
    "locate_orthographic",
    "locate_pair",
    "main",
    "marks_csv",
    "materials",
    "modes",
    "overlay",
    "parse_quantity",
    "picture",
    "points_csv",
    "pull_back_batch",
    "reach",
    "reach_batch",
    "score",
    "simulate",
    "solve_batch",
    "solve_cases",
    "suite",
    "svg",
    "design",
    "sweep",
    "table_in_si",
    "toml",
    "triangulate",
    "workspace",
    "write_file",
]

VERSION: str

def main(arguments: list[str]) -> int: ...
def examples() -> list[tuple[str, bytes]]: ...
def reach(
    setup: Setup,
    model: Model,
    asked: dict[str, Any],
    shape: list[tuple[int, list[float]]] | None,
) -> tuple[Solution, dict[str, Any]]: ...
def reach_batch(
    setup: Setup,
    model: Model,
    asked: dict[str, Any],
    rows: _Array,
    threads: int | None,
    nearest: bool,
    progress: Callable[[int], None] | None,
) -> dict[str, Any]: ...
def follow(
    setup: Setup,
    model: Model,
    asked: dict[str, Any],
    rows: _Array | None,
    times: list[float],
    nearest: bool,
) -> dict[str, Any]: ...
def workspace(
    setup: Setup,
    model: Model,
    asked: dict[str, Any],
    voxel: float | None,
    has_stiffness: bool,
    budget: tuple[int, int] | None,
) -> dict[str, Any]: ...
def simulate(setup: Setup, timeout: float | None) -> tuple[dict[str, Any], Exception | None]: ...
def modes(setup: Setup, count: int, time: float | None) -> dict[str, Any]: ...
def design(
    setup: Setup,
    model: Model,
    targets: list[dict[str, Any]],
    chosen: bool,
    samples: bool,
) -> dict[str, Any]: ...
def sweep(
    setup: Setup,
    model: Model,
    asked: dict[str, Any],
    out: str,
    shard: tuple[int, int],
    resume: bool,
) -> dict[str, Any]: ...
def export(
    setup: Setup,
    model: Model,
    format: str,
    stem: str,
    per_span: int | None,
) -> tuple[list[tuple[str, bytes]], list[str]]: ...
def parse_quantity(text: str, dimension: str) -> float: ...
def table_in_si(name: str, table: dict[str, Any]) -> dict[str, Any]: ...
def materials() -> list[dict[str, Any]]: ...
def toml(tables: dict[str, Any]) -> str: ...
def write_file(path: str, content: bytes) -> None: ...
def benchmark(
    setups: list[Setup],
    models: list[str],
    reference: str,
    suite: str | None = None,
    only: list[str] = ...,
    timeout: float | None = None,
) -> tuple[str, str, str | None]: ...
def suite(name: str, only: list[str] = ...) -> list[tuple[str, Setup]]: ...
def svg(
    setup: Setup,
    solutions: list[tuple[str, Solution]],
    width: float,
    title: str | None = None,
) -> str: ...
def derivatives(
    setup: Setup,
    model: Model,
    parameters: list[str],
    tension: Any = None,
    shortening: Any = None,
    motors: Any = None,
    start: Solution | None = None,
) -> tuple[Solution, Derivatives]: ...
def solve_batch(
    setup: Setup,
    model: Model,
    values: _Array,
    driven_by: str,
    threads: int | None,
    path: bool,
    progress: Callable[[int], None] | None,
) -> tuple[_Array, _Array, _Array, _Array, Outcomes]: ...
def solve_cases(
    setups: list[Setup],
    model: Model,
    threads: int | None,
    progress: Callable[[int], None] | None,
) -> list[Solution | SolveError | InputError]: ...
def pull_back_batch(
    setup: Setup,
    model: Model,
    values: _Array,
    driven_by: str,
    parameters: list[str],
    threads: int | None,
    progress: Callable[[int], None] | None,
    positions: _Array | None = None,
    rotations: _Array | None = None,
    tensions: _Array | None = None,
    lengths: _Array | None = None,
) -> tuple[_Array, _Array, Outcomes]: ...

@final
class Model:
    def __new__(
        cls,
        kind: str,
        *,
        stations: int | tuple[float, ...] | None = None,
        actuation: str | None = None,
        tolerance: float | None = None,
        steps: int | None = None,
        stability: bool | str | None = None,
        residual: float | None = None,
        max_iterations: int | None = None,
        objective: str | None = None,
        chord: str | None = None,
        length_rule: str | None = None,
        coefficients: str | None = None,
        timeout: float | None = None,
    ) -> Model: ...
    @property
    def kind(self) -> str: ...
    @property
    def arguments(self) -> dict[str, Any]: ...

@final
class Controller:
    def __new__(
        cls, setup: Setup, model: Model, asked: dict[str, Any], options: dict[str, Any]
    ) -> Controller: ...
    @property
    def actuators(self) -> list[tuple[str, str]]: ...
    def cycle(
        self, target: dict[str, Any], measured: dict[str, Any] | None
    ) -> tuple[Solution, dict[str, Any]]: ...

@final
class Simulation:
    def __new__(cls, setup: Setup) -> Simulation: ...
    def step(self, dt: float, tension: Any = None, shortening: Any = None, motors: Any = None) -> None: ...
    def set_loads(self, setup: Setup) -> None: ...
    def read(self) -> dict[str, Any]: ...
    def arc_length(self) -> _Array: ...
    @property
    def time(self) -> float: ...
    @property
    def method(self) -> str: ...
    def state(self) -> SimulationState: ...
    def restore(self, state: SimulationState) -> None: ...
    def modes(self, count: int) -> dict[str, Any]: ...
    def linearize(self) -> dict[str, Any]: ...
    def base_wrench(self) -> list[float]: ...
    def momentum(self) -> list[float]: ...
    def angular_momentum(self) -> list[float]: ...
    def commands(self) -> list[tuple[str, float]]: ...

@final
class SimulationState: ...

_FailedRows = list[tuple[int, WhipcordError]]

@final
class Motions:
    def __new__(cls, setup: Setup, dt: float) -> Motions: ...
    def arc_length(self) -> _Array: ...
    def sizes(self) -> tuple[int, int]: ...
    def run(
        self, actuation: str, commands: _Array, threads: int | None = None
    ) -> tuple[dict[str, Any], _FailedRows]: ...
    def gradient(
        self,
        actuation: str,
        commands: _Array,
        position: _Array,
        velocity: _Array,
        strain: _Array,
        threads: int | None = None,
    ) -> tuple[dict[str, Any], _FailedRows]: ...
    def tangent(
        self,
        actuation: str,
        commands: _Array,
        changes: _Array,
        factors: _Array,
        threads: int | None = None,
    ) -> tuple[dict[str, Any], _FailedRows]: ...

@final
class Board:
    def __new__(cls, layout: str, square: float, marker: float | None, dictionary: str | None) -> Board: ...
    def find(self, photo: Photo) -> Seen: ...

@final
class Seen:
    def __new__(cls, size: Sequence[int], points: _Array, pixels: _Array) -> Seen: ...
    @property
    def corners(self) -> list[tuple[int, list[float], list[float]]]: ...

_Deviations = tuple[list[float], list[float], list[float | None], float, list[list[float]]]
_Refused = list[tuple[int, str]]

def calibrate(
    seen: list[Seen], distortion: str
) -> tuple[Camera, _Deviations, tuple[float, list[float], float], list[int], _Refused, list[str]]: ...

_Points = tuple[_Array, _Array, _Array, _Array, _Array]

def calibrate_two(
    cameras: list[Camera],
    seen: list[list[Seen]],
    board: Board | None = None,
) -> tuple[list[Camera], dict[str, Any]]: ...
def locate_pair(
    cameras: list[Camera],
    points: list[_Array],
    pixels: list[_Array],
    view: Sequence[float] | None = None,
    pixel_deviation: float | None = None,
) -> tuple[list[Camera], list[_Array], list[float], tuple[Camera, float] | None, bool, _Sure]: ...
def triangulate(cameras: list[Camera], pixels: list[_Array], deviation: float) -> _Points: ...
def in_space(
    cameras: list[Camera], marks: list[list[Any]], has_numbers: bool, limit: float, deviation: float
) -> tuple[list[int], _Points, list[tuple[list[int], float | None, str]], list[list[int]]]: ...
def points_csv(step: int | None, points: list[Any]) -> str: ...

@final
class Photo:
    @staticmethod
    def load(path: str) -> Photo: ...
    @staticmethod
    def of_array(pixels: npt.NDArray[np.uint8]) -> Photo: ...
    @property
    def size(self) -> list[int]: ...
    def pixels(self) -> npt.NDArray[np.uint8]: ...
    def png(self) -> bytes: ...
    def find(
        self,
        kind: str,
        colour: list[int] | None,
        radius: float | None,
        mask: Photo | None,
        count: int | None,
        places: list[float] | None,
        hidden: list[int],
        base: str | None,
        near: list[float] | None,
        timeout: float | None = None,
    ) -> list[tuple[int, list[float], float, list[float], float]]: ...
    def annotated(self, kind: str, marks: list[Any]) -> Photo: ...

def marks_csv(step: int | None, camera: str | None, marks: list[Any]) -> str: ...
def picture(svg: str, path: str) -> bytes: ...
def overlay(
    photo: Photo,
    setup: Setup,
    camera: Camera,
    seen_by: int | None,
    marks: list[Any] | None,
    table: str | None,
    step: int,
    models: list[str],
    title: str,
    width: float,
    timeout: float | None = None,
) -> tuple[
    str | None,
    list[tuple[int | None, float, list[float], list[float]]],
    list[tuple[str, Solution | None, _Array, list[float] | None, Any]],
]: ...
def fit(
    setups: list[Setup],
    model: Model,
    parameters: list[Any],
    each: list[Any],
    loss: str,
    confidence: float,
    iterations: int,
    validate: bool,
    models: list[Model],
    test: list[Setup],
    part: tuple[float, int] | None,
    ladder: bool,
    profile: bool,
    skip: bool,
    one_frame: bool,
    starts: int,
    threads: int | None,
) -> Fitted: ...

@final
class Fitted:
    def json(self) -> str: ...
    def places(self) -> list[tuple[int, int, float, int | None]]: ...
    def setups(self) -> list[Setup]: ...
    def text(self, number: int, folder: str) -> str | None: ...
    def report(self, folder: str) -> Any: ...

def score(setups: list[Setup], models: list[Model], threads: int | None = None) -> Scored: ...

@final
class Scored:
    def json(self, rows: bool) -> str: ...
    def report(self, folder: str, figures: bool) -> Any: ...

@final
class Setup:
    @staticmethod
    def load(path: str) -> Setup: ...
    @staticmethod
    def parse(text: str, name: str) -> Setup: ...
    @staticmethod
    def of_tables(tables: dict[str, Any], of: str) -> Setup: ...
    def tables(self) -> dict[str, Any]: ...
    @property
    def title(self) -> str: ...
    @property
    def measured(self) -> dict[str, Any] | None: ...
    def warnings(self) -> list[_Notice]: ...
    def answer_warnings(self, of: Solution) -> list[_Notice]: ...
    def spacing_warnings(self, model: Model, of: Solution) -> list[_Notice]: ...
    @property
    def reference(self) -> dict[str, Any] | None: ...
    def disks(self) -> list[float]: ...
    def base(self) -> list[float]: ...
    def beside(self, other: Setup, measured: bool, reference: bool) -> Setup: ...
    def beside_goal(self, other: Setup) -> Setup: ...
    def with_measured(self, measured: dict[str, Any]) -> Setup: ...
    def stations(self, model: Model) -> _Array: ...
    def solve(
        self,
        model: Model,
        tension: Any = None,
        shortening: Any = None,
        motors: Any = None,
        start: Solution | None = None,
        least_squares: bool = False,
    ) -> Solution: ...
    def solve_steps(
        self, model: Model, tension: Any = None, shortening: Any = None, motors: Any = None
    ) -> list[Solution]: ...
    def initial_lengths(self, model: Model) -> list[float]: ...
    def cable_paths(self, solution: Solution) -> list[_Array]: ...
    def motors(self, of: Solution) -> list[dict[str, Any]]: ...
    def cable_overlaps(self, solution: Solution) -> list[dict[str, Any]]: ...
    def of_answer(self, solution: Solution) -> Setup: ...
    def as_driven(self, solution: Solution, model: Model) -> Setup: ...
    def parameter(self, path: str) -> float: ...
    def with_parameters(self, values: list[tuple[str, float]]) -> Setup: ...
    def local(
        self,
        model: Model,
        arc_length: float | None,
        tension: Any = None,
        shortening: Any = None,
        motors: Any = None,
    ) -> tuple[Solution, dict[str, Any]]: ...
    def branches(
        self, model: Model, tension: Any = None, shortening: Any = None, motors: Any = None
    ) -> tuple[
        list[tuple[int | None, bool | None, Solution]],
        list[tuple[int, float, str, list[float]]],
        bool,
    ]: ...

@final
class Solution:
    @property
    def model(self) -> str: ...
    @property
    def arc_length(self) -> _Array: ...
    @property
    def position(self) -> _Array: ...
    @property
    def orientation(self) -> _Array: ...
    @property
    def plastic_curvature(self) -> _Array: ...
    @property
    def disk_arc_length(self) -> _Array: ...
    @property
    def disk_position(self) -> _Array: ...
    @property
    def disk_orientation(self) -> _Array: ...
    @property
    def cables(self) -> list[dict[str, Any]]: ...
    @property
    def base_wrench(self) -> list[float] | None: ...
    @property
    def contacts(self) -> list[dict[str, Any]]: ...
    @property
    def grasps(self) -> list[dict[str, Any]]: ...
    @property
    def objects(self) -> list[dict[str, Any]]: ...
    @property
    def diagnostics(self) -> dict[str, Any]: ...
    @property
    def bend(self) -> tuple[float, float]: ...
    def rms_distance(self, other: Solution) -> float: ...
    def csv(self) -> str: ...
    def state(self) -> tuple[Any, ...]: ...
    @staticmethod
    def from_state(setup: Setup, state: tuple[Any, ...]) -> Solution: ...

@final
class Outcomes:
    @property
    def ok(self) -> npt.NDArray[np.bool_]: ...
    @property
    def failed(self) -> npt.NDArray[np.int64]: ...
    @property
    def stable(self) -> npt.NDArray[np.bool_]: ...
    @property
    def unstable(self) -> npt.NDArray[np.bool_]: ...
    def diagnostic(self, name: str) -> _Array: ...
    def error(self, row: int) -> SolveError | InputError | None: ...
    def __len__(self) -> int: ...

@final
class Derivatives:
    def one_sided(self) -> list[str]: ...
    def lengths_dependent(self) -> bool: ...
    def commands(self) -> _Array: ...
    def tensions(self) -> _Array: ...
    def parameters(self, hold: str) -> _Array: ...
    def cables_by_parameters(self, hold: str) -> tuple[_Array, _Array]: ...
    def length_by_tension(self) -> _Array: ...
    def length_by_command(self) -> _Array: ...
    def compliance(self, station: int | None, hold: str) -> _Array: ...
    def stiffness(self, station: int | None, hold: str) -> _Array | None: ...
    def pull_back(
        self,
        hold: str,
        position: _Array | None = None,
        rotation: _Array | None = None,
        tension: _Array | None = None,
        length: _Array | None = None,
    ) -> dict[str, Any]: ...

def distances(
    setup: Setup, answers: list[Solution]
) -> (
    tuple[
        float | None,
        list[tuple[int | None, bool, int, float]],
        _Array,
        _Array,
        tuple[list[float], list[float]] | None,
        list[int],
    ]
    | None
): ...

_Place = tuple[list[float], list[float]]
_Sure = tuple[_Array | None, float | None]
_Located = tuple[Camera, _Array, float, tuple[Camera, float] | None, bool, _Sure, float | None]

def locate_orthographic(
    points: _Array,
    pixels: _Array,
    size: Sequence[int] | None = None,
    view: Sequence[float] | None = None,
    pixel_deviation: float | None = None,
) -> _Located: ...

@final
class Camera:
    @staticmethod
    def pinhole(
        focal: Sequence[float],
        centre: Sequence[float],
        distortion: Sequence[float],
        place: tuple[Sequence[float], Sequence[float]],
        size: Sequence[int] | None,
    ) -> Camera: ...
    @staticmethod
    def orthographic(
        scale: float,
        centre: Sequence[float],
        place: tuple[Sequence[float], Sequence[float]],
        size: Sequence[int] | None,
    ) -> Camera: ...
    @staticmethod
    def load(path: str) -> Camera: ...
    def text(self, path: str) -> str: ...
    def with_lens_covariance(self, rows: list[list[float]] | None) -> Camera: ...
    @property
    def lens_covariance(self) -> list[list[float]] | None: ...
    @property
    def lens(self) -> tuple[list[float], list[float]] | None: ...
    @property
    def scale(self) -> float | None: ...
    @property
    def centre(self) -> list[float]: ...
    @property
    def place(self) -> _Place: ...
    @property
    def extrinsics(self) -> tuple[list[float], list[float]]: ...
    @property
    def size(self) -> list[int] | None: ...
    def project(self, points: _Array) -> _Array: ...
    def undistort(self, pixels: _Array) -> _Array: ...
    def rays(self, pixels: _Array) -> _Array: ...
    def locate(
        self,
        points: _Array,
        pixels: _Array,
        view: Sequence[float] | None = None,
        pixel_deviation: float | None = None,
    ) -> _Located: ...
