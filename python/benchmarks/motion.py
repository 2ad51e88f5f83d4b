"""A rod that falls from straight, beside PyElastica and MuJoCo: ``python python/benchmarks/motion.py`` with the package, pyelastica and mujoco installed.

A clamped, horizontal, undamped rod is let go under gravity. PyElastica integrates the same Cosserat rod by explicit steps, MuJoCo a chain of rigid links with
springs in ball joints. The reference is the method `accurate` with 40 elements and steps of 0.1 ms. Printed are the root mean square of the
distance of the tip from the reference over the time, and how many times faster than real time each runs on one core; compilation is not counted.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

LENGTH, DIAMETER, YOUNG, DENSITY, GRAVITY = 0.3, 4e-3, 50e6, 1040.0, 9.81
POISSON = 0.3
AREA = np.pi / 4 * DIAMETER**2
INERTIA = np.pi / 64 * DIAMETER**4


def whipcord_tip(duration: float, every: float, elements: int, step: float) -> tuple[Array, float]:
    """Tip (N, 3) at the times, and the seconds that it took."""
    import whipcord

    backbone = whipcord.Backbone(
        length=LENGTH, diameter=DIAMETER, young_modulus=YOUNG, poisson_ratio=POISSON, density=DENSITY
    )
    case = whipcord.Case(whipcord.Robot(backbone=backbone), loads=whipcord.Loads(gravity=[-GRAVITY, 0, 0]))
    run = lambda: case.simulate(duration, step=step, every=every, initial="rest", elements=elements)  # noqa: E731
    run()
    start = time.perf_counter()
    motion = run()
    return motion.tip, time.perf_counter() - start


def mujoco_tip(duration: float, every: float, links: int, step: float, integrator: str) -> tuple[Array, float]:
    """The same by a chain of rigid links; joints lie in the middle of the elements, so that the error is of second order."""
    import mujoco

    size = LENGTH / links
    stiffness = YOUNG * INERTIA / size
    mass = DENSITY * AREA * size

    def link(k: int) -> str:
        # The first joint is half an element from the base; the last link is half as long.
        long = size if k < links - 1 else 0.5 * size
        part = mass * long / size
        across, along = part * long**2 / 12 + part * DIAMETER**2 / 16, part * DIAMETER**2 / 8
        place = 0.5 * size if k == 0 else size
        inner = link(k + 1) if k < links - 1 else f'<site name="tip" pos="0 0 {long}"/>'
        return (
            f'<body pos="0 0 {place}"><joint type="ball" stiffness="{stiffness}"/>'
            f'<inertial pos="0 0 {long / 2}" mass="{part}" diaginertia="{across} {across} {along}"/>{inner}</body>'
        )

    xml = (
        f'<mujoco><option timestep="{step}" gravity="{-GRAVITY} 0 0" integrator="{integrator}"/>'
        f"<worldbody>{link(0)}</worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    steps, rows = round(every / step), round(duration / every)
    tip = [data.site("tip").xpos.copy()]
    start = time.perf_counter()
    for _ in range(rows):
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)
        tip.append(data.site("tip").xpos.copy())
    return np.array(tip), time.perf_counter() - start


def elastica_tip(duration: float, every: float, elements: int, step: float) -> tuple[Array, float]:
    """The same by PyElastica."""
    import elastica

    class System(  # type: ignore[misc]
        elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.CallBacks
    ):
        pass

    def make() -> tuple[object, object]:
        system = System()
        rod = elastica.CosseratRod.straight_rod(
            elements,
            np.zeros(3),
            np.array([0.0, 0.0, 1.0]),
            np.array([1.0, 0.0, 0.0]),
            LENGTH,
            DIAMETER / 2,
            DENSITY,
            youngs_modulus=YOUNG,
            shear_modulus=YOUNG / (2 * (1 + POISSON)),
        )
        system.append(rod)
        system.constrain(rod).using(
            elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
        )
        system.add_forcing_to(rod).using(elastica.GravityForces, acc_gravity=np.array([-GRAVITY, 0.0, 0.0]))
        system.finalize()
        return system, rod

    stepper = elastica.PositionVerlet()
    steps, rows = round(every / step), round(duration / every)

    def run(rows: int) -> tuple[Array, float]:
        system, rod = make()
        at, tip = np.float64(0.0), [rod.position_collection[:, -1].copy()]  # type: ignore[attr-defined]
        start = time.perf_counter()
        for _ in range(rows):
            for _ in range(steps):
                at = stepper.step(system, at, np.float64(step))
            tip.append(rod.position_collection[:, -1].copy())  # type: ignore[attr-defined]
        return np.array(tip), time.perf_counter() - start

    run(1)
    return run(rows)


def main() -> None:
    """Prints a line for each program and setting."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=2.0, help="time in s that is simulated")
    duration, every = parser.parse_args().duration, 0.02
    # MuJoCo writes a log of its warnings where it runs.
    os.chdir(tempfile.mkdtemp())
    reference, _ = whipcord_tip(duration, every, 40, 1e-4)
    settings: list[tuple[str, int, float, Callable[[], tuple[Array, float]]]] = []
    for elements, step in ((4, 0.02), (6, 0.01), (10, 0.01), (10, 0.005)):
        run = lambda e=elements, s=step: whipcord_tip(duration, every, e, s)  # noqa: E731
        settings.append(("whipcord", elements, step, run))
    for links, step, integrator in (
        (10, 1e-3, "implicitfast"),
        (10, 2e-4, "implicitfast"),
        (10, 5e-4, "RK4"),
        (20, 1e-4, "RK4"),
        (40, 5e-5, "RK4"),
    ):
        run = lambda n=links, s=step, i=integrator: mujoco_tip(duration, every, n, s, i)  # noqa: E731
        settings.append((f"MuJoCo, {integrator}", links, step, run))
    for elements, step in ((10, 1e-5), (20, 1e-5), (40, 5e-6)):
        run = lambda e=elements, s=step: elastica_tip(duration, every, e, s)  # noqa: E731
        settings.append(("PyElastica", elements, step, run))
    print(f"{'':22} {'elements':>8} {'step':>9} {'error':>10} {'real-time factor':>17}")
    for name, count, step, run in settings:
        try:
            tip, seconds = run()
        except (ImportError, ValueError, AttributeError) as error:
            print(f"{name:22} {error}")
            continue
        error = np.sqrt(((tip - reference) ** 2).sum(axis=1).mean())
        # Beyond that the motion has nothing to do with the rod.
        text = f"{1e3 * error:7.2f} mm" if error < 0.5 * LENGTH else "  unstable"
        print(f"{name:22} {count:8} {1e3 * step:6.4g} ms {text} {duration / seconds:17.4g}")


if __name__ == "__main__":
    main()
