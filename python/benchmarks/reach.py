"""Reaching planted tips beside SciPy: ``python python/benchmarks/reach.py`` with the package and SciPy installed.

For each of ten robots random commands within the limits give tips. Four solvers get the same tips, the same model (`cosserat` with its default
options), the same limits and the same start, the least tensions or motors at zero:

- ``case.reach``, one target after the other, with its atlas of shapes to start from again,
- SciPy's ``least_squares`` (trust region reflective), with the exact Jacobian of ``case.differentiate``,
- the same with Jacobians from finite differences of ``case.solve``,
- Levenberg–Marquardt with such Jacobians, each step cut off at the limits.

``python python/benchmarks/reach.py 20 motors`` asks for 20 tips of the robots in whose names there is "motors".

A tip counts as reached if a solve of the commands has it within 1e-5 of the length.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence

import numpy as np
import whipcord
from scipy.optimize import least_squares
from whipcord import Backbone, Cable, Case, Disks, Motor, Robot, Routing

LENGTH = 0.18


def robot(cables: Sequence[Cable], taper: bool = False, motors: Sequence[Motor] = ()) -> Robot:
    """A rod with ten disks and these cables."""
    diameter = {"diameters": list(np.linspace(0.0036, 0.002, 10))} if taper else {"diameter": "3 mm"}
    backbone = Backbone(length=LENGTH, young_modulus="1.1 GPa", poisson_ratio=0.3, **diameter)
    holes = 12 if any(cable.holes for cable in cables) else None
    disks = Disks(count=10, hole_circle_radius="8 mm", holes=holes)
    return Robot(backbone=backbone, disks=disks, cables=cables, motors=motors)


def straight(count: int, turn: float = 0.0, ends_at: float | None = None) -> list[Cable]:
    """So many straight cables about the backbone, from an angle in degrees on."""
    angles = [turn + 360.0 * k / count for k in range(count)]
    return [
        Cable(name=f"straight at {angle:.0f}", routing=Routing.straight(angle=f"{angle} deg", radius="8 mm"), ends_at=ends_at)
        for angle in angles
    ]


def helix(turns: float, angle: float = 0.0) -> Cable:
    """A helical cable that starts at an angle in degrees."""
    routing = Routing.helix(turns=turns, radius="8 mm", start_angle=f"{angle} deg")
    return Cable(name=f"{turns} turns from {angle:.0f}", routing=routing)


def converging() -> list[Cable]:
    """Four cables that approach the axis."""
    cables = []
    for k in range(4):
        way = np.array([np.cos(0.5 * np.pi * k), np.sin(0.5 * np.pi * k)])
        routing = Routing.linear(start=list(0.008 * way), end=list(0.003 * way))
        cables.append(Cable(name=f"converging {k}", routing=routing))
    return cables


def holes() -> list[Cable]:
    """Four cables through holes at other places of each disk."""
    lists = [
        [1, 2, 3, 4, 4, 4, 4, 3, 2, 1],
        [4, 5, 6, 7, 8, 9, 10, 11, 12, 1],
        [7, 7, 7, 6, 5, 4, 3, 3, 3, 3],
        [10, 9, 8, 8, 9, 10, 11, 12, 12, 12],
    ]
    return [Cable(name=f"holes {k}", holes=of) for k, of in enumerate(lists)]


def with_motors() -> Robot:
    """Two motors that pull two opposite cables each, behind soft drives."""
    cables = straight(4)
    names = [cable.name for cable in cables]
    motors = [
        Motor(name="x", cables=[names[0], f"-{names[2]}"], spool_radius="5 mm", stiffness="2 N/mm", pretension="1 N"),
        Motor(name="y", cables=[names[1], f"-{names[3]}"], spool_radius="5 mm", stiffness="2 N/mm", pretension="1 N"),
    ]
    return robot(cables, motors=motors)


#: Robots with the range of the tensions in N, or of the motors in rad.
ROBOTS: dict[str, tuple[Robot, float, float]] = {
    "three straight cables": (robot(straight(3)), 0.1, 4.0),
    "two straight, a helix": (robot([*straight(3)[:2], helix(1.0, 240.0)]), 0.1, 4.0),
    "three straight, a helix": (robot([*straight(3), helix(1.0)]), 0.1, 4.0),
    "four through holes": (robot(holes()), 0.1, 4.0),
    "four converging": (robot(converging()), 0.1, 4.0),
    "tapered": (robot(straight(4), taper=True), 0.1, 2.0),
    "two segments, six cables": (robot([*straight(3, ends_at=0.1), *straight(3, 60.0)]), 0.1, 4.0),
    "six helices": (robot([helix(turns, 120.0 * k) for turns in (0.75, -0.75) for k in range(3)]), 0.1, 4.0),
    "three segments, nine cables": (
        robot([*straight(3, ends_at=0.06), *straight(3, 40.0, ends_at=0.12), *straight(3, 80.0)]),
        0.1,
        4.0,
    ),
    "two motors": (with_motors(), -1.0, 1.0),
}


def tip(solution: whipcord.Solution) -> np.ndarray:
    """Position of the tip in m, shape (3,)."""
    return np.asarray(solution.position)[-1]


def levenberg_marquardt(
    residual: Callable[[np.ndarray], np.ndarray], start: np.ndarray, least: float, greatest: float
) -> np.ndarray:
    """The least squares of residuals by finite differences, each step cut off at the limits."""
    x, damping = start.copy(), 1e-3
    value = residual(x)
    for _ in range(100):
        step = 1e-6 * (greatest - least)
        columns = [(residual(x + step * unit) - value) / step for unit in np.eye(len(x))]
        jacobian = np.transpose(columns)
        normal = jacobian.T @ jacobian
        while damping < 1e8:
            scaled = normal + damping * np.diag(np.diag(normal) + 1e-15)
            trial = np.clip(x - np.linalg.solve(scaled, jacobian.T @ value), least, greatest)
            moved = residual(trial)
            if moved @ moved < value @ value:
                break
            damping *= 4.0
        else:
            break
        small = value @ value - moved @ moved < 1e-12 * (value @ value)
        x, value, damping = trial, moved, max(damping / 9.0, 1e-9)
        if small or value @ value < 1e-14:
            break
    return x


def main(count: int = 100, only: str = "") -> None:
    """Prints how many of so many tips each solver reaches, and its median time."""
    for name, (of, least, greatest) in ROBOTS.items():
        if only not in name:
            continue
        random = np.random.default_rng(7)
        case = Case(of)
        driven = "motors" if of.motors else "tension"
        size = len(of.motors) or len(of.cables)

        def solve(command: np.ndarray, case: Case = case, driven: str = driven) -> whipcord.Solution:
            return case.solve(**{driven: command})

        targets = [tip(solve(random.uniform(least, greatest, size))) for _ in range(count)]
        start = np.full(size, 0.0 if of.motors else least)
        limits = None if of.motors else {"tension": [least, greatest]}

        def ours(target: np.ndarray, case: Case = case, limits: dict[str, list[float]] | None = limits) -> np.ndarray:
            by = "motors" if case.robot.motors else "tensions"
            return np.asarray(case.reach(tip=target, limits=limits, by=by, least="change").command)

        def residual(command: np.ndarray, target: np.ndarray) -> np.ndarray:
            return (tip(solve(command)) - target) / LENGTH

        def jacobian(command: np.ndarray, target: np.ndarray) -> np.ndarray:
            _, derivatives = case.differentiate(**{driven: command})
            return np.asarray(derivatives.position_by_command)[-1] / LENGTH

        def scipy(jac: object) -> Callable[[np.ndarray], np.ndarray]:
            def solver(target: np.ndarray) -> np.ndarray:
                found = least_squares(residual, start, jac, (least, greatest), args=(target,), xtol=1e-12, ftol=1e-12)
                return found.x

            return solver

        def marquardt(target: np.ndarray) -> np.ndarray:
            return levenberg_marquardt(lambda x: residual(x, target), start, least, greatest)

        solvers = {
            "case.reach": ours,
            "SciPy, exact Jacobian": scipy(jacobian),
            "SciPy, differences": scipy("2-point"),
            "Levenberg-Marquardt, differences": marquardt,
        }
        for label, solver in solvers.items():
            if of.motors and label == "SciPy, exact Jacobian":
                # The Jacobian of a case with motors is by the commands of its cables.
                continue
            reached = 0
            seconds = []
            for target in targets:
                begun = time.perf_counter()
                try:
                    command = solver(target)
                except whipcord.WhipcordError:
                    command = None
                seconds.append(time.perf_counter() - begun)
                if command is not None:
                    reached += bool(np.linalg.norm(tip(solve(command)) - target) <= 1e-5 * LENGTH)
            print(f"{name}, {label}: {reached} of {count}, {1e3 * np.median(seconds):.2f} ms")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:3])
