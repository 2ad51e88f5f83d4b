"""Benchmark of the models: the package says what the command says."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord import InputError


def test_the_package_says_what_the_command_says(case: whipcord.Case, tmp_path: Path) -> None:
    by = ["cosserat", "four-bar"]
    benchmark = whipcord.benchmark(case, by=by, reference="cosserat:fine")
    file = tmp_path / "case.toml"
    case.save(file)
    chosen = [word for name in by for word in ("--model", name)]
    command = [sys.executable, "-m", "whipcord", "compare", file, *chosen, "--out", tmp_path / "report"]
    done = subprocess.run(
        [*command, "--reference", "cosserat:fine", "--json"], check=True, capture_output=True
    )
    told = json.loads(done.stdout)
    runs = told["cases"][0]["runs"]
    assert [(row.model, row.preset) for row in benchmark.rows] == [
        (run["model"], run["preset"]) for run in runs
    ]
    for row, run in zip(benchmark.rows, runs, strict=True):
        assert row.rms == pytest.approx(run["error"]["rms"], abs=1e-9)
        assert row.reference == "cosserat at fine resolution" and row.failure is None
    assert [finding.topic for finding in benchmark.recommendation] == [one["topic"] for one in told["recommendation"]]
    # What the command warns of, Python warns of when the case is made and answered.
    assert json.loads(benchmark.to_json()).keys() == told.keys() - {"warnings"}
    # Of an answer of the model itself, by another way.
    disks = case.solve(model="cosserat").disks.position
    lengths = {row.preset: row for row in benchmark.rows if row.model == "four-bar"}
    assert lengths["usual"].commands == "reference"
    assert 0.005 < (lengths["usual"].rms_over_length or 0) < 0.05
    fine = case.solve(model=whipcord.models.Cosserat(tolerance=1e-12)).disks.position
    rms = np.sqrt(((disks - fine)[1:] ** 2).sum(axis=1).mean())
    assert benchmark.rows[0].rms == pytest.approx(rms, abs=1e-11)


def test_a_benchmark_is_a_table_a_text_and_a_picture(case: whipcord.Case, tmp_path: Path) -> None:
    benchmark = whipcord.compare(case, by=["four-bar", "constant-curvature"], reference="cosserat").benchmark
    assert benchmark is not None and {row.model for row in benchmark.rows} == {"four-bar", "constant-curvature"}
    refused = benchmark.rows[-1]
    assert refused.rms is None and refused.failure is not None and "parallel" in refused.failure
    assert {standing.answered for standing in benchmark.standings} == {0, 1}
    assert "Which model for what" in str(benchmark) and "2 cases" not in repr(benchmark)
    assert benchmark.svg is not None and benchmark.svg.startswith("<svg")
    assert benchmark._repr_html_() is not None
    for name, first in (("chart.svg", b"<svg"), ("chart.png", b"\x89PNG")):
        benchmark.save_plot(tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(first)
    with pytest.raises(InputError, match=r"must end in \.svg or \.png"):
        benchmark.save_plot(tmp_path / "chart.pdf")
    frame = pytest.importorskip("pandas") and benchmark.to_pandas()
    assert len(frame) == len(benchmark.rows) and frame["solve_time"].notna().sum() == 3


def test_suites_are_tried_and_looked_at() -> None:
    cases = whipcord.suite("routing", only=["straight-5-30", "wall-9-30"])
    assert list(cases) == ["straight-5-30", "wall-9-30"]
    assert cases["wall-9-30"].obstacles[0].name == "wall"
    benchmark = whipcord.benchmark("routing", by=["four-bar"], reference="cosserat", only=["straight-5-30"])
    row = benchmark.rows[0]
    assert (row.name, row.routing, row.burden, row.sections) == ("straight-5-30", "straight", "none", 5)
    assert row.bending == pytest.approx(np.pi / 6)
    # A case of the suite is a case as any other, but that it is not said what it stands for.
    again = whipcord.benchmark([cases["straight-5-30"]], by=["four-bar"], reference="cosserat")
    assert again.rows[0].rms == row.rms and again.rows[0].routing is None


def test_without_a_reference_there_is_no_recommendation(case: whipcord.Case) -> None:
    benchmark = whipcord.benchmark(case, by=["cosserat"], reference="measured")
    assert benchmark.recommendation == () and benchmark.svg is None
    assert "nothing in space" in benchmark.no_reference[case.title]
    with pytest.raises(InputError, match="nothing to draw"):
        benchmark.save_plot("chart.svg")


def test_what_cannot_be_tried_is_said(case: whipcord.Case) -> None:
    for options, path, words in (
        ({"cases": "spirals"}, "suite", "there is no suite `spirals`: choose routing"),
        ({"cases": "routing", "only": ["spiral"]}, "only", "no case of the suite has spiral in its name"),
        ({"cases": case, "reference": "four-bar:fine"}, "reference", "four-bar has no resolution to refine"),
        ({"cases": case, "by": ["cosserats"]}, "by", "there is no model `cosserats`"),
        ({"cases": case, "by": "cosserat"}, "by", "by must be a list of names"),
        ({"cases": [], "by": ["cosserat"]}, "cases", "there is no case"),
        ({"cases": [3]}, "cases", "but one is 3"),
        ({"cases": case, "only": ["a"]}, "only", "only picks cases of a suite"),
    ):
        with pytest.raises(InputError) as caught:
            whipcord.benchmark(**options)  # type: ignore[arg-type]
        assert words in str(caught.value) and caught.value.path == path
