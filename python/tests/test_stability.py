"""What is computed of the stability of an answer."""

from __future__ import annotations

import pytest

import whipcord
from whipcord import models


@pytest.mark.parametrize(
    "kind",
    [models.Cosserat, models.CosseratDisks, models.PiecewiseConstantCurvature, models.PseudoRigidBody],
)
def test_the_verdict_does_not_depend_on_the_eigenvalue(kind: type) -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    plain, least, none = (case.solve(model=kind(stability=what)) for what in (True, "eigenvalue", False))
    assert plain.stable is least.stable is True
    assert least.diagnostics.stability is not None and least.diagnostics.stability > 0
    assert none.stable is None and none.diagnostics.stability_absent == "not-asked"
    assert (plain.position == least.position).all()


def test_another_analysis_is_an_input_error() -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    with pytest.raises(whipcord.InputError, match="eigenvalue"):
        case.solve(model=models.Cosserat(stability="all"))  # type: ignore[arg-type]
