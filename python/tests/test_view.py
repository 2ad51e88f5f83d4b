"""The viewer as Python starts it."""

from __future__ import annotations

import urllib.error
import urllib.request

import pytest
import whipcord


def page_or_skip(of: whipcord.Case | whipcord.Robot | whipcord.Solution) -> whipcord.Viewer:
    try:
        return of.view(open=False, height=500)
    except whipcord.WhipcordError as error:
        if "without the page" not in str(error):
            raise
        pytest.skip("built without Node")


def test_cases_robots_and_solutions_are_viewed() -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    for of in (case, case.robot, case.solve()):
        with page_or_skip(of) as viewer:
            with urllib.request.urlopen(viewer.url) as answer:
                assert b"viewer.js" in answer.read()
            assert f'<iframe src="{viewer.url}"' in viewer._repr_html_()
            assert "height: 500px" in viewer._repr_html_()
        with pytest.raises(urllib.error.URLError):
            urllib.request.urlopen(viewer.url)
