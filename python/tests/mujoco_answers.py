"""Static answers of MuJoCo, for the tests and for the figure of the documentation.

``python -m python.tests.mujoco_answers OUT.svg`` in the root of the project compares all robots and draws the figure.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import whipcord


@dataclass(frozen=True)
class Compared:
    """A robot that is compared."""

    file: str
    """Example file."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """What `Case.replace` changes."""
    loads: Mapping[str, Any] | None = None
    """Other loads."""
    cables: tuple[Mapping[str, Any], ...] | None = None
    """Other cables."""
    disks: Mapping[str, Any] | None = None
    """Other disks."""
    per_span: int = 4
    """Bodies between two disks."""
    within: float = 0.005
    """Greatest distance of a disk, as a part of the length."""


SEGMENT = "examples/three-cable-segment.toml"
HELIX = {"name": "helix", "routing": whipcord.Routing.helix(turns=0.5, radius="8 mm", start_angle="30 deg")}

ROBOTS = {
    "planar": Compared("examples/table1/case-1.toml"),
    "helical": Compared("examples/table1/case-4.toml"),
    "two segments": Compared("examples/two-segment-arm.toml"),
    "weight and stream": Compared("examples/wall-mounted-arm.toml"),
    "tip load": Compared(
        SEGMENT, loads={"tip_force": ["0.3 N", "0.2 N", "-0.1 N"], "tip_moment": [0, 0, "5 mN*m"]}
    ),
    "following load": Compared(
        "examples/table1/case-2.toml", loads={"tip_force": ["0.2 N", "0.1 N", 0], "follower": True}
    ),
    "tapered": Compared("examples/tapered-arm.toml"),
    "pre-curved": Compared("examples/precurved-catheter.toml"),
    "many disks": Compared(
        "examples/table1/case-3.toml",
        {"tension": ["4 N"]},
        cables=(HELIX,),
        disks={"count": 28, "hole_circle_radius": "8 mm"},
    ),
    "slack": Compared(SEGMENT, {"tension": ["5 N", 0, 0]}),
    "large bending": Compared(SEGMENT, {"tension": ["16 N", "1 N", "1 N"]}, per_span=8),
    "coupled stiffness": Compared("examples/composite-finger.toml"),
}


def of_robot(robot: Compared) -> whipcord.Case:
    """The case of a robot that is compared."""
    case = whipcord.load(robot.file)
    if robot.cables is not None:
        arm = case.robot.replace(cables=[whipcord.Cable(**dict(each)) for each in robot.cables])
        if robot.disks is not None:
            arm = arm.replace(disks=whipcord.Disks(**dict(robot.disks)))
        case = whipcord.Case(arm, tension=robot.changes["tension"])
    elif robot.changes:
        case = case.replace(**dict(robot.changes))
    if robot.loads is not None:
        case = case.replace(loads=whipcord.Loads(**dict(robot.loads)))
    return case


def at_rest(
    model: Any, start: str, *, end: str = "case", ramp: float = 0.5, slowest: float = 1e-5, longest: float = 60.0
) -> Any:
    """MuJoCo's data after all has come to rest: from a keyframe, with the controls of another one reached within `ramp` s. A robot at
    which a velocity is more than `slowest` after `longest` s is not at rest: a RuntimeError."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(start).id)
    first, last = data.ctrl.copy(), model.key(end).ctrl.copy()
    while data.time < longest:
        for _ in range(100):
            data.ctrl[:] = first + (last - first) * min(1.0, data.time / ramp)
            mujoco.mj_step(model, data)
        if data.time > ramp and np.abs(data.qvel).max() < slowest:
            mujoco.mj_forward(model, data)
            return data
    raise RuntimeError(f"not at rest after {longest} s: {np.abs(data.qvel).max()} rad/s")


def disks_in(model: Any, data: Any) -> npt.NDArray[np.float64]:
    """Positions of the disks."""
    names = [model.site(i).name for i in range(model.nsite)]
    count = sum(name.startswith("disk:") for name in names)
    return np.array([data.site(f"disk:{k}").xpos for k in range(1, count + 1)])


def bodies(model: Any) -> int:
    """Bodies of the robot."""
    names = [model.body(i).name for i in range(model.nbody)]
    return sum(name == "base" or name.startswith("node:") for name in names)


def distance(case: whipcord.Case, exact: npt.NDArray[np.float64], per_span: int) -> tuple[float, Any]:
    """The greatest distance in m of a disk in MuJoCo from where it should be, and where MuJoCo has the disks."""
    import mujoco

    with tempfile.TemporaryDirectory() as folder:
        made = case.export(Path(folder) / "robot.xml", model="cosserat-disks", per_span=per_span)
        model = mujoco.MjModel.from_xml_path(str(made.files[0]))
    found = disks_in(model, at_rest(model, "rest"))
    return float(np.linalg.norm(found - exact, axis=1).max()), found


COUNTS = (1, 2, 4, 8)


def draw(path: str) -> None:
    """Compares all robots, prints a table and draws the figure."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "whipcord"
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(4, 4, figsize=(9, 9), layout="constrained")
    panels = axes[:3].flatten()
    grid = axes[3, 0].get_gridspec()
    for axis in axes[3]:
        axis.remove()
    chart = figure.add_subplot(grid[3, :])
    colours = plt.get_cmap("tab20")
    print("| robot | " + " | ".join(str(count) for count in COUNTS) + " |")
    print("|---|" + "---|" * len(COUNTS))
    for panel, (name, robot) in zip(panels, ROBOTS.items()):
        case = of_robot(robot)
        solution = case.solve(model="cosserat-disks")
        exact, length = solution.position, float(solution.arc_length[-1])
        compared = [distance(case, exact, count) for count in COUNTS]
        shares = [100 * apart / length for apart, _ in compared]
        print(f"| {name} | " + " | ".join(f"{share:.2f} %" for share in shares) + " |", flush=True)
        shown = compared[COUNTS.index(robot.per_span)][1]
        smooth = case.solve(model="cosserat-disks", stations=120).position
        # In the plane that the shape comes nearest to.
        middle = smooth.mean(axis=0)
        across = np.linalg.svd(smooth - middle)[2][:2]
        panel.plot(*(across @ (smooth - middle).T * 1e3), color="#d55e00", lw=2)
        panel.plot(*(across @ (shown - middle).T * 1e3), "o", color="#222222", ms=3.5, mfc="none")
        panel.set_title(f"{name}: {shares[COUNTS.index(robot.per_span)]:.2f} %", fontsize=9)
        panel.set_aspect("equal", "datalim")
        panel.tick_params(labelsize=7)
        chart.loglog(COUNTS, shares, "-o", ms=3, lw=1, label=name, color=colours(len(chart.lines)))
    chart.axhline(0.5, color="#8c8c8c", ls="--", lw=1)
    chart.set_xticks(COUNTS, [str(count) for count in COUNTS])
    chart.minorticks_off()
    chart.set_xlabel("bodies between two disks")
    chart.set_ylabel("greatest distance of a disk,\n% of the length")
    chart.legend(fontsize=7, ncols=3, loc="lower left")
    chart.set_ylim(bottom=0.003)
    figure.suptitle("cosserat-disks (line) and MuJoCo (rings), mm", fontsize=11)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    draw(sys.argv[1])
