"""The viewer: a robot in the browser, or in a notebook."""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
import tempfile
import webbrowser
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError, WhipcordError

if TYPE_CHECKING:
    from .case import Case
    from .robot import Robot
    from .solution import Shape, Solution

#: Height of the page in a notebook, in px.
HEIGHT = 640


class Viewer:
    """A page of the viewer, with the process that serves it: until :meth:`close`, or the end of Python.

    In a notebook it shows the page itself. It is a context manager, which closes it.
    """

    def __init__(self, text: str, *, model: str | None = None, height: int = HEIGHT) -> None:
        self._serve([text], [] if model is None else ["--model", model], height)

    def _serve(self, texts: list[str], options: list[str], height: int) -> None:
        """Starts the process for these robot files, of which the first has the sliders."""
        self._folder = tempfile.TemporaryDirectory(prefix="whipcord-")
        paths = [os.path.join(self._folder.name, f"robot-{k + 1}.toml") for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        command = [sys.executable, "-m", "whipcord", "view", paths[0], "--no-open", *options]
        for path in paths[1:]:
            command += ["--beside", path]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True)
        self._height = height
        assert self._process.stdout is not None
        self._url = self._process.stdout.readline().strip()
        if not self._url:
            _, message = self._process.communicate()
            self._folder.cleanup()
            raise WhipcordError(message.strip().removeprefix("error: "))
        atexit.register(self.close)

    @property
    def url(self) -> str:
        """Where the page is, on this machine."""
        return self._url

    def show(self) -> None:
        """Opens the page in a tab of the browser."""
        webbrowser.open_new_tab(self._url)

    def close(self) -> None:
        """Ends the process that serves the page."""
        atexit.unregister(self.close)
        self._process.terminate()
        try:
            self._process.communicate()
        except BrokenPipeError:  # what was not written yet is not wanted any more
            self._process.wait()
        self._folder.cleanup()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Viewer({self._url!r})"

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self._height}px; border: 0"
        return f'<iframe src="{self._url}" style="{style}" title="The viewer of whipcord"></iframe>'


class View(Viewer):
    """Robots in the viewer, whose shapes a program shows as they come: in the browser, or in a notebook where it is displayed.

    The page is served by a process of its own until :meth:`close`, or the end of Python. A timeline keeps what was shown: it can be
    paused, played again and filmed. The sliders of the first robot are back with the button "Live".

    Parameters
    ----------
    robots
        Robots or cases, each where its base is. The first has the sliders of the page.
    open
        Whether a tab of the browser is opened: by default, except in a notebook.
    height
        Height of the page in a notebook, in px.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/two-segment-arm.toml")
    >>> with whipcord.View(case, open=False) as viewer:  # doctest: +SKIP
    ...     for pull in (0, 2, 4, 6):
    ...         viewer.show(case.solve(tension=[pull, 0, 0, 0, 0, 0]))
    """

    def __init__(self, *robots: Robot | Case, open: bool | None = None, height: int = HEIGHT) -> None:
        if not robots:
            raise InputError("no robot is given: View(robot)")
        self._cables = [_cables(robot) for robot in robots]
        self._serve([robot.to_toml() for robot in robots], ["--stream"], height)
        if open if open is not None else not in_notebook():
            webbrowser.open_new_tab(self._url)

    def show(
        self,
        *shapes: Solution | Shape | None,
        time: float | None = None,
        measured: npt.ArrayLike | None = None,
    ) -> None:
        """Shows a shape of each robot, at once in all pages that are open; without any it opens the page in a tab of the browser.

        Parameters
        ----------
        shapes
            Solutions, or frames along a backbone, in the order of the robots. A robot for which it is ``None``, or for which
            none is given, stays as it is.
        time
            Time in s, which the timeline shows and plays by; by default since the first shape.
        measured
            (n, 3) positions of markers in m, which are drawn as well.
        """
        if not shapes and measured is None:
            super().show()
            return
        if len(shapes) > len(self._cables):
            raise InputError(
                f"{len(shapes)} shapes are given for {len(self._cables)} robots: View(robot, other, ...)"
            )
        given = zip(shapes, self._cables, strict=False)
        line: dict[str, Any] = {
            "shapes": [None if shape is None else _line(shape, cables) for shape, cables in given]
        }
        if time is not None:
            line["time"] = float(time)
        if measured is not None:
            points = np.asarray(measured, dtype=float)
            if points.ndim != 2 or points.shape[1] != 3:
                raise InputError(f"measured has the shape {points.shape}: give (n, 3) positions in m")
            line["measured"] = points.tolist()
        try:
            text = json.dumps(line, allow_nan=False)
        except ValueError:
            raise InputError("a number that is to be shown is not finite") from None
        pipe = self._process.stdin
        assert pipe is not None
        try:
            pipe.write(text + "\n")
            pipe.flush()
        except (BrokenPipeError, ValueError):
            raise WhipcordError("the viewer is closed: make another View") from None

    def __repr__(self) -> str:
        return f"View({self._url!r})"


def _cables(robot: Robot | Case) -> int:
    """How many cables it has."""
    from .robot import Robot

    return len(robot.cables if isinstance(robot, Robot) else robot.robot.cables)


def _line(shape: Solution | Shape, cables: int) -> dict[str, Any]:
    """A shape as the viewer reads it."""
    from .solution import Solution

    made: dict[str, Any] = {
        "arc_length": shape.arc_length.tolist(),
        "positions": shape.position.tolist(),
        "orientations": shape.orientation.tolist(),
    }
    if isinstance(shape, Solution):
        made["model"] = offered(shape._model)
        if len(shape.tension) == cables:
            made["tensions"] = [None if np.isnan(value) else float(value) for value in shape.tension]
    return made


def view(text: str, *, model: str | None = None, open: bool | None = None, height: int = HEIGHT) -> Viewer:
    """Serves the viewer of a robot file's text, as :meth:`whipcord.Case.view` says; the page begins with this model."""
    viewer = Viewer(text, model=model, height=height)
    if open if open is not None else not in_notebook():
        viewer.show()
    return viewer


def offered(model: _core.Model) -> str:
    """What the viewer calls a model. It knows the options that answer something else; how exactly a rod is solved is its own."""
    if model.kind == "four-bar" and model.arguments.get("length_rule") == "free":
        energy = model.arguments.get("objective") == "strain-energy"
        return "four-bar-strain-energy" if energy else "four-bar-sliding"
    return model.kind


def in_notebook() -> bool:
    """Whether a notebook shows what is returned."""
    ipython: Any = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and shell.has_trait("kernel")
