"""The viewer: a robot in the browser, or in a notebook."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import tempfile
import webbrowser
from typing import Any

from . import _core
from .errors import WhipcordError

#: Height of the page in a notebook, in px.
HEIGHT = 640


class Viewer:
    """A page of the viewer, with the process that serves it: until :meth:`close`, or the end of Python.

    In a notebook it shows the page itself. It is a context manager, which closes it.
    """

    def __init__(self, text: str, *, model: str | None = None, height: int = HEIGHT) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="whipcord-")
        path = os.path.join(self._folder.name, "robot.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        command = [sys.executable, "-m", "whipcord", "view", path, "--no-open"]
        if model is not None:
            command += ["--model", model]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
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
        self._process.communicate()
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
