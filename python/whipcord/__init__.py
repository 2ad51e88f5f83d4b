"""Mechanics of cable-driven continuum robots with any cable routing.

One robot file, every model of the robot:

>>> import whipcord
>>> case = whipcord.load(whipcord.examples.path("table1/case-3.toml"))
>>> solution = case.solve()
>>> solution.position.shape
(10, 3)

SI units everywhere; wherever a quantity is asked for, a text with a unit such as ``"180 mm"`` will do. The
frame of the base has z along the backbone's tangent there; quaternions are (w, x, y, z).
"""

from typing import TYPE_CHECKING

from . import errors, examples, models
from ._core import VERSION as __version__
from .batch import Batch, Gradients
from .benchmarking import Benchmark, Finding, Row, Standing, benchmark, suite
from .calibration import Calibration
from .camera import Camera, Located
from .case import Case, load
from .cases import solve_cases
from .comparison import Comparison, Distances, Run, compare
from .controlling import Controller, Cycle, Estimator
from .derivatives import Derivatives, Dexterity, Gradient, Place
from .errors import (
    CalibrationError,
    DetectionError,
    FileError,
    FitError,
    InputError,
    ModelError,
    MotionError,
    SolveError,
    WhipcordError,
)
from .exporting import Exported
from .fitting import (
    CrossValidation,
    Estimate,
    Fit,
    HeldOut,
    ModelFit,
    Profile,
    Rung,
    Suspect,
    Unknown,
    Unresolved,
    UnstableAnswer,
    fit,
)
from .loads import Base, DistributedLoad, Loads, PointLoad, PointMass, Step
from .material import Material, materials
from .motor import Motor
from .obstacles import Obstacle
from .overlaying import Overlaid, Overlay, overlay
from .photographs import Marks, measure
from .published import Measured, Observation, Reference
from .reaching import Followed, Jump, Limits, ReachBatch, Reached
from .robot import (
    Along,
    Backbone,
    BackboneSegment,
    Cable,
    Damping,
    Disks,
    Robot,
    Routing,
    Section,
    SectionStiffness,
)
from .scoring import CaseScore, Measures, ModelScore, RowScore, Score, score
from .motions import MotionBatch, MotionChange, MotionGradient, Motions
from .simulating import Linearized, Modes, Motion, Simulation, State
from .solution import (
    Branches,
    CableOverlap,
    CableState,
    Contact,
    CriticalPoint,
    Diagnostics,
    Equilibrium,
    Grasp,
    MotorState,
    ObjectContact,
    ObjectState,
    Shape,
    Solution,
)
from .stereo import (
    LocatedPair,
    PointsInSpace,
    StereoCalibration,
    StereoPair,
    Triangulated,
    locate_stereo,
    measure_stereo,
    triangulate,
)
from .designing import Designed, DesignTarget, design
from .surveying import Boundary, Workspace
from .sweeping import Sweep
from .viewing import View, Viewer
from .warning import WhipcordWarning

__all__ = [
    "Along",
    "Backbone",
    "BackboneSegment",
    "Base",
    "Batch",
    "Benchmark",
    "Boundary",
    "Branches",
    "Cable",
    "CableOverlap",
    "CableState",
    "Calibration",
    "CalibrationError",
    "Camera",
    "Case",
    "CaseScore",
    "Comparison",
    "Contact",
    "Controller",
    "CriticalPoint",
    "CrossValidation",
    "Cycle",
    "Damping",
    "Derivatives",
    "DetectionError",
    "Dexterity",
    "DesignTarget",
    "Designed",
    "Diagnostics",
    "Disks",
    "Distances",
    "DistributedLoad",
    "Equilibrium",
    "Estimate",
    "Estimator",
    "Exported",
    "FileError",
    "Finding",
    "Fit",
    "FitError",
    "Followed",
    "Gradient",
    "Gradients",
    "Grasp",
    "HeldOut",
    "InputError",
    "Jump",
    "Limits",
    "Linearized",
    "Loads",
    "Located",
    "LocatedPair",
    "Marks",
    "Material",
    "Measured",
    "Measures",
    "ModelError",
    "ModelFit",
    "ModelScore",
    "Modes",
    "Motion",
    "MotionBatch",
    "MotionError",
    "MotionChange",
    "MotionGradient",
    "Motions",
    "Motor",
    "MotorState",
    "ObjectContact",
    "ObjectState",
    "Observation",
    "Obstacle",
    "Overlaid",
    "Overlay",
    "Place",
    "PointLoad",
    "PointMass",
    "PointsInSpace",
    "Profile",
    "ReachBatch",
    "Reached",
    "Reference",
    "Robot",
    "Routing",
    "Row",
    "RowScore",
    "Run",
    "Rung",
    "Score",
    "Section",
    "SectionStiffness",
    "Shape",
    "Simulation",
    "Solution",
    "SolveError",
    "Standing",
    "State",
    "Step",
    "StereoCalibration",
    "StereoPair",
    "Suspect",
    "Sweep",
    "Triangulated",
    "Unknown",
    "Unresolved",
    "UnstableAnswer",
    "View",
    "Viewer",
    "WhipcordError",
    "WhipcordWarning",
    "Workspace",
    "__version__",
    "benchmark",
    "compare",
    "design",
    "errors",
    "examples",
    "fit",
    "load",
    "locate_stereo",
    "materials",
    "measure",
    "measure_stereo",
    "models",
    "overlay",
    "plot",
    "score",
    "solve_cases",
    "suite",
    "triangulate",
]


if TYPE_CHECKING:
    from . import plot
else:

    def __getattr__(name: str) -> object:
        # Matplotlib takes a second to import, and not everybody draws.
        if name == "plot":
            import importlib

            return importlib.import_module(".plot", __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
