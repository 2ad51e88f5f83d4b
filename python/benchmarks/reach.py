"""Reaching planted tips beside SciPy: ``python python/benchmarks/reach.py`` with the package and SciPy installed.

For each robot random tensions within the limits give tips. Three solvers get the same tips, the same model (`cosserat` with its default
options), the same limits and the same start, the least tensions:

- ``case.reach``, with its atlas of shapes to start from again,
- SciPy's ``least_squares`` (trust region reflective), with the exact Jacobian of ``case.differentiate``,
- the same with Jacobians from finite differences of ``case.solve``.

A tip counts as reached if a solve of the commands has it within 1e-5 of the length.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import whipcord
from scipy.optimize import least_squares

ROOT = Path(__file__).resolve().parents[2]
#: Example files, with the range of the tensions in N.
ROBOTS = {
    "three-cable-segment": (0.2, 6.0),
    "two-segment-arm": (0.2, 6.0),
    "helical-finger": (0.2, 4.0),
    "tapered-arm": (0.2, 4.0),
    "composite-finger": (0.2, 6.0),
}


def tip(solution: whipcord.Solution) -> np.ndarray:
    """Position of the tip in m, shape (3,)."""
    return np.asarray(solution.position)[-1]


def main(count: int = 100) -> None:
    """Prints how many of so many tips each solver reaches, and its mean time."""
    random = np.random.default_rng(7)
    for name, (least, greatest) in ROBOTS.items():
        case = whipcord.load(ROOT / f"examples/{name}.toml")
        cables = len(case.robot.cables)
        length = case.robot.backbone.length
        targets = []
        while len(targets) < count:
            try:
                targets.append(tip(case.solve(tension=random.uniform(least, greatest, cables))))
            except whipcord.WhipcordError:
                continue
        start = np.full(cables, least)
        limits = {"tension": [least, greatest]}

        def ours(target: np.ndarray) -> np.ndarray:
            answer = case.reach(tip=target, limits=limits, by="tensions", least="change")
            return np.asarray(answer.tension)

        def residual(tension: np.ndarray, target: np.ndarray) -> np.ndarray:
            return (tip(case.solve(tension=tension)) - target) / length

        def jacobian(tension: np.ndarray, target: np.ndarray) -> np.ndarray:
            _, derivatives = case.differentiate(tension=tension)
            return np.asarray(derivatives.position_by_command)[-1] / length

        def scipy(jac: object) -> Callable[[np.ndarray], np.ndarray]:
            def solve(target: np.ndarray) -> np.ndarray:
                found = least_squares(
                    residual, start, jac, (least, greatest), args=(target,), xtol=1e-12, ftol=1e-12
                )
                return found.x

            return solve

        for label, solver in (
            ("case.reach", ours),
            ("SciPy, exact Jacobian", scipy(jacobian)),
            ("SciPy, differences", scipy("2-point")),
        ):
            reached, seconds = 0, 0.0
            for target in targets:
                begun = time.perf_counter()
                try:
                    tension = solver(target)
                except whipcord.WhipcordError:
                    tension = None
                seconds += time.perf_counter() - begun
                if tension is not None:
                    off = np.linalg.norm(tip(case.solve(tension=tension)) - target)
                    reached += bool(off <= 1e-5 * length)
            print(f"{name}, {label}: {reached} of {count}, {1e3 * seconds / count:.2f} ms each")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
