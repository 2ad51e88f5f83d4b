"""What is fitted is what was put in, and what the command says."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import whipcord
from scipy.optimize import least_squares
from whipcord import Case, InputError, Unknown, errors

YOUNG = "backbone.young_modulus"
RADIUS = "cables[0].routing.radius"
REAL = {YOUNG: 1.3e9, RADIUS: 0.0074}


@pytest.fixture
def cases(tmp_path: Path) -> list[Case]:
    """Three cases of a robot that is stiffer, and whose hole is nearer to the axis, than its file says; seen to
    0.2 mm."""
    robot = whipcord.Robot(
        backbone=whipcord.Backbone(length=0.18, diameter=0.003, young_modulus=1.1e9, poisson_ratio=0.3),
        disks=whipcord.Disks(count=10, hole_circle_radius=0.008),
        cables=[whipcord.Cable(name="pull", routing=whipcord.Routing.straight(angle=0, radius=0.008))],
    )
    rng = np.random.default_rng(5)
    made = []
    for i, tension in enumerate((1.0, 2.0, 3.5)):
        # Without a weight at its tip only the product of radius and tension over stiffness is seen.
        case = Case(
            robot, tension=[tension], loads=whipcord.Loads(tip_force=[0.05, 0.02, 0]), title=f"pull {i}"
        )
        seen = case.with_parameters(REAL).solve().position + rng.normal(0, 2e-4, (10, 3))
        table = tmp_path / f"disks-{i}.csv"
        lines = [f"{k + 1},{x!r},{y!r},{z!r}" for k, (x, y, z) in enumerate(seen.tolist())]
        table.write_text("\n".join(["disk,x,y,z", *lines]) + "\n")
        made.append(case.with_measured(table))
    return made


def test_what_was_put_in_comes_out(cases: list[Case]) -> None:
    found = whipcord.fit(cases, [YOUNG, Unknown(RADIUS, start=0.0085, least=0.005, greatest=0.01)])
    assert found.status == "converged" and len(found.residuals) == 30 and found.noise_estimated
    for path, real in REAL.items():
        estimate = found[path]
        assert estimate.deviation is not None and estimate.interval is not None
        assert abs(estimate.value - real) < 3 * estimate.deviation < 0.1 * real
        assert estimate.derivatives == "exact" and not estimate.at_bound
    assert found.noise == pytest.approx(2e-4, rel=0.2)

    # SciPy comes to the same from the same numbers.
    def left(values: np.ndarray) -> np.ndarray:
        assumed = dict(zip((YOUNG, RADIUS), values * [1e9, 1e-2]))
        rows = []
        for case in cases:
            assert case.measured is not None
            rows.append(case.with_parameters(assumed).solve().position - case.measured.position)
        return np.concatenate(rows).ravel()

    other = least_squares(left, [1.1, 0.8], xtol=1e-12, ftol=1e-12)
    assert np.allclose(other.x * [1e9, 1e-2], found.values, rtol=1e-5)
    assert np.allclose(left(found.values / [1e9, 1e-2]), found.residuals.ravel(), atol=1e-9)
    covariance = np.linalg.inv(other.jac.T @ other.jac)
    expected = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert found.correlations[0, 1] == pytest.approx(expected, abs=1e-3)
    deviation = np.sqrt(2 * other.cost / (90 - 2) * covariance.diagonal()) * [1e9, 1e-2]
    assert np.allclose([estimate.deviation for estimate in found.estimates], deviation, rtol=1e-3)


def test_the_command_says_the_same(cases: list[Case], tmp_path: Path) -> None:
    files = [str(tmp_path / f"case-{i}.toml") for i in range(3)]
    for case, file in zip(cases, files):
        case.save(file)
    loaded = [whipcord.load(file) for file in files]

    def told(*options: str) -> object:
        given = ["--parameter", YOUNG, "--parameter", RADIUS, *options, "--json"]
        command = [sys.executable, "-m", "whipcord", "fit", *files, *given]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    each = ["base.position[2]"]
    found = whipcord.fit(loaded, [YOUNG, RADIUS], each=each, loss="huber", compare_models=True)
    said = told("--each", *each, "--loss", "huber", "--compare-models")
    assert json.loads(found.to_json()) == said
    assert [estimate.case for estimate in found.estimates] == [None, None, "case-0", "case-1", "case-2"]
    refused = {each.model for each in found.models if each.error is not None}
    assert len(found.models) == len(whipcord.models.NAMES) and refused == {"four-bar", "constant-curvature"}
    assert min(each.aic_above_best for each in found.models if each.aic_above_best is not None) == 0.0
    assert found.correlations.shape == (5, 5) and found.weights.max() <= 1.0

    found = whipcord.fit(loaded, [YOUNG, RADIUS], cross_validate=True)
    assert json.loads(found.to_json()) == told("--cross-validate")
    assert found.cross_validation is not None and len(found.cross_validation.held_out) == 3


def test_a_fit_is_saved_drawn_and_reported(cases: list[Case], tmp_path: Path) -> None:
    text = (
        cases[0]
        .to_toml()
        .replace("young_modulus = 1100000000.0", 'young_modulus = "1.1 GPa" # from the shop')
    )
    (tmp_path / "case.toml").write_text(text + f'\n[fit]\nparameters = ["{YOUNG}", "{RADIUS}"]\n')
    case = whipcord.load(tmp_path / "case.toml")
    found = whipcord.fit(case)
    assert [estimate.parameter for estimate in found.estimates] == [YOUNG, RADIUS]
    found.save_robot(tmp_path / "fitted.toml")
    saved = (tmp_path / "fitted.toml").read_text()
    assert "# from the shop" in saved and "GPa" in saved and "[fit]" in saved
    again = whipcord.load(tmp_path / "fitted.toml")
    assert again.parameter(YOUNG) == pytest.approx(found[YOUNG].value, rel=1e-9)
    assert again.measured is not None
    # The fitted case holds the same, and is saved with what is to be fitted.
    assert found.cases[0].parameter(YOUNG) == found[YOUNG].value
    found.cases[0].save(tmp_path / "written.toml")
    assert "[fit]" in (tmp_path / "written.toml").read_text()
    compared = whipcord.compare(found.cases[0], by=["cosserat"])["cosserat"].distance_to_measured
    assert (
        compared is not None
        and compared < whipcord.compare(case, by=["cosserat"])["cosserat"].distance_to_measured
    )
    report = Path(found.report(tmp_path / "report"))
    assert "<h2>Estimates</h2>" in report.read_text()
    names = {path.name for path in report.parent.iterdir()}
    assert {"report.html", "estimates.csv", "residuals.csv", "distances.svg", "distances.png"} <= names
    axes = found.plot_residuals()
    assert axes.get_xlabel() == "arc length (mm)"
    plt.close("all")
    assert "backbone.young_modulus 1." in repr(found)


def test_what_cannot_be_told_apart_is_said(cases: list[Case]) -> None:
    found = whipcord.fit(cases, [YOUNG, "backbone.diameter"])
    (unresolved,) = found.unresolved
    assert set(unresolved.parameters) == {YOUNG, "backbone.diameter"}


def test_any_number_of_threads_gives_the_same_bits(cases: list[Case]) -> None:
    one, two = (whipcord.fit(cases, [YOUNG, RADIUS], threads=threads) for threads in (1, 2))
    assert [of.value for of in one.estimates] == [of.value for of in two.estimates]
    assert np.array_equal(one.residuals, two.residuals)


def test_what_cannot_be_fitted_is_refused(cases: list[Case]) -> None:
    for given, words in [
        ((cases, []), "nothing is to be estimated"),
        ((cases, ["backbone.young_module"]), "did you mean backbone.young_modulus"),
        ((cases, YOUNG), "must be a list of paths"),
        ((cases, [3]), "must be a list of paths"),
        (([], [YOUNG]), "there is no case"),
        (([cases[0], 3], [YOUNG]), r"cases\[1\] must be a Case"),
        ((cases[0].replace(tension=[9.0]), [YOUNG]), r"cases\[0\] has no measurements"),
        (([cases[0], cases[1].with_parameters({YOUNG: 1e9})], [YOUNG]), "the backbone differ"),
        ((cases, [Unknown(YOUNG, start="a")]), "start must be a number"),
        ((cases, [Unknown(YOUNG, least=2.0, greatest=1.0)]), "least value must be below"),
    ]:
        with pytest.raises(InputError, match=words):
            whipcord.fit(*given)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="has no friction: use cosserat"):
        whipcord.fit(cases, ["cables.friction"], model="constant-curvature")
    with pytest.raises(InputError, match="there is no loss `l1`"):
        whipcord.fit(cases, [YOUNG], loss="l1")  # type: ignore[arg-type]
    with pytest.raises(errors.FitError, match=r"cases\[0\]: no answer") as start:
        whipcord.fit(cases, [Unknown(YOUNG, start=1e3)])
    assert start.value.case == 0 and isinstance(start.value.__cause__, whipcord.SolveError)
    with pytest.raises(errors.FitNotConvergedError, match="has not converged") as stopped:
        whipcord.fit(cases, [Unknown(YOUNG, start=9e9), RADIUS], iterations=1)
    assert stopped.value.iterations == 1


def test_a_measurement_in_a_frame_of_its_own_is_moved(cases: list[Case], tmp_path: Path) -> None:
    path = tmp_path / "moved.toml"
    cases[0].save(path)
    text = path.read_text().replace('registration = "none"\n', "")
    path.write_text(text.replace("[measured]\n", '[measured]\nregistration = "rigid"\n'))
    moved = whipcord.load(path)
    assert moved.measured is not None and moved.measured.registration == "rigid"
    found = whipcord.fit([moved], [YOUNG])
    parameters = [estimate.parameter for estimate in found.estimates]
    assert parameters[1:] == [f"measured.{of}[{axis}]" for of in ("position", "turn") for axis in range(3)]
    one = whipcord.fit([moved], [YOUNG], one_frame=True)
    assert one[YOUNG].value == pytest.approx(found[YOUNG].value) and one.estimates[1].case is None


def test_markers_in_opposite_order_are_spoken_of(cases: list[Case], tmp_path: Path) -> None:
    assert whipcord.fit(cases[0], [YOUNG]).warnings == ()
    table = tmp_path / "turned.csv"
    rows = (tmp_path / "disks-0.csv").read_text().splitlines()[1:]
    turned = [f"{11 - int(row.split(',')[0])},{row.split(',', 1)[1]}" for row in rows]
    table.write_text("\n".join(["disk,x,y,z", *turned]) + "\n")
    (warning,) = whipcord.fit(cases[0].with_measured(table), [YOUNG]).warnings
    assert "opposite order" in warning.message
    # Where the base is what is sought, the order is not told by the place it has in the file.
    base = [f"base.{of}[{axis}]" for of in ("position", "turn") for axis in range(3)]
    assert whipcord.fit(cases[0], base).warnings == ()
