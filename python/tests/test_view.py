"""The viewer as Python starts it."""

from __future__ import annotations

import base64
import json
import os
import socket
import struct
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import whipcord
from whipcord.models import CosseratDisks, FourBar


class Page:
    """What a page of the viewer hears and says: as much of a WebSocket (RFC 6455) as that takes."""

    def __init__(self, url: str) -> None:
        at = urllib.parse.urlsplit(url)
        assert at.hostname is not None and at.port is not None
        self._socket = socket.create_connection((at.hostname, at.port), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            "GET /socket HTTP/1.1",
            f"Host: {at.netloc}",
            f"Origin: http://{at.netloc}",
            "Connection: Upgrade",
            "Upgrade: websocket",
            "Sec-WebSocket-Version: 13",
            f"Sec-WebSocket-Key: {key}",
        ]
        self._socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self._file = self._socket.makefile("rb")
        assert b" 101 " in self._file.readline()
        while self._file.readline().strip():
            pass

    def hear(self) -> dict[str, Any]:
        """The next message."""
        kind, length = self._file.read(2)
        assert kind == 0x81, "a whole text"
        if length == 126:
            (length,) = struct.unpack(">H", self._file.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self._file.read(8))
        message: dict[str, Any] = json.loads(self._file.read(length))
        return message

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """The answer to a request."""
        text = json.dumps({"type": "solve", **request}).encode()
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(text))
        self._socket.sendall(struct.pack(">BBH", 0x81, 0x80 | 126, len(text)) + mask + masked)
        return self.hear()

    def close(self) -> None:
        self._file.close()
        self._socket.close()


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


SOLVES: list[tuple[str, Callable[[whipcord.Case], whipcord.Solution]]] = [
    ("two-segment-arm", lambda case: case.solve(tension=[3, 9, 1, 0, 2, 5])),
    ("two-segment-arm", lambda case: case.solve(model="cosserat-disks", tension=[3, 9, 1, 0, 2, 5])),
    ("two-segment-arm", lambda case: case.replace(loads=whipcord.Loads(tip_force=[0.1, 0, 0])).solve()),
    # This file gives tension and shortening.
    ("table1/case-3", lambda case: case.solve()),
    ("table1/case-3", lambda case: case.solve(model="four-bar")),
    ("table1/case-3", lambda case: case.solve(model=CosseratDisks(steps=20), actuation="shortening")),
    ("table1/case-3", lambda case: case.solve(model=FourBar(length_rule="free", objective="strain-energy"))),
    ("rubbing-finger", lambda case: case.solve(model="cosserat-disks")),
]


@pytest.mark.parametrize(("name", "solve"), SOLVES)
def test_a_solution_is_viewed_as_it_is(
    name: str, solve: Callable[[whipcord.Case], whipcord.Solution]
) -> None:
    solution = solve(whipcord.load(f"examples/{name}.toml"))
    with page_or_skip(solution) as viewer:
        page = Page(viewer.url)
        scene = page.hear()
        assert scene["type"] == "scene" and len(scene["initial"]["models"]) == 1
        frame = page.ask(scene["initial"])
        page.close()
    (answer,) = frame["answers"]
    assert answer["status"] == "solved" and answer["model"].startswith(solution.model)
    assert answer["driven_by"] is None
    np.testing.assert_allclose(answer["positions"][-1], solution.tip, atol=2e-6)


def view_or_skip(*robots: whipcord.Case | whipcord.Robot) -> whipcord.View:
    try:
        return whipcord.View(*robots, open=False)
    except whipcord.WhipcordError as error:
        if "without the page" not in str(error):
            raise
        pytest.skip("built without Node")


def test_shapes_of_several_robots_are_shown_as_they_come() -> None:
    arm, finger = (
        whipcord.load("examples/two-segment-arm.toml"),
        whipcord.load("examples/helical-finger.toml"),
    )
    with view_or_skip(arm, finger.robot) as viewer:
        page = Page(viewer.url)
        assert page.hear()["type"] == "scene"
        other = page.hear()
        assert other["type"] == "beside" and other["number"] == 1
        markers = [[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]]
        for pull in (1.0, 4.0):
            first, second = arm.solve(tension=[pull, 0, 0, 0, 0, 0]), finger.solve(tension=[0.2 * pull])
            viewer.show(first, second, time=pull, measured=markers)
            shown = page.hear()
            assert shown["type"] == "shown" and shown["time"] == pull and shown["measured"] == markers
            for answer, solution in zip(shown["shapes"], (first, second), strict=True):
                assert answer["model"] == solution.model
                np.testing.assert_allclose(answer["positions"][-1], solution.tip, atol=1e-12)
                tensions = [cable["tension"] for cable in answer["cables"]]
                np.testing.assert_allclose(tensions, solution.tension)
        # Frames alone, and of the second robot alone.
        viewer.show(None, finger.solve(tension=[0.1]).disks)
        shown = page.hear()
        assert shown["shapes"][0] is None and shown["shapes"][1]["status"] == "solved"
        page.close()
        assert viewer.url in viewer._repr_html_()


def test_what_cannot_be_shown_is_refused() -> None:
    arm = whipcord.load("examples/two-segment-arm.toml")
    with pytest.raises(whipcord.InputError, match="no robot"):
        whipcord.View()
    viewer = view_or_skip(arm)
    solution = arm.solve()
    with pytest.raises(whipcord.InputError, match="2 shapes"):
        viewer.show(solution, solution)
    with pytest.raises(whipcord.InputError, match=r"\(n, 3\)"):
        viewer.show(solution, measured=[0.0, 0.0, 1.0])
    with pytest.raises(whipcord.InputError, match="not finite"):
        viewer.show(solution, time=float("nan"))
    viewer.close()
    with pytest.raises(whipcord.WhipcordError, match="closed"):
        viewer.show(solution)
