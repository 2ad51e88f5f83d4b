"""Every public function says what each of its parameters is."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from typing import Any

import pytest
import whipcord
import whipcord.models
import whipcord.plot

MODULES = (whipcord, whipcord.models, whipcord.plot)


def methods(kind: type) -> Iterator[tuple[str, Any]]:
    for name, member in inspect.getmembers(kind):
        # What Python's own classes bring, such as `with_traceback`, is documented there.
        if name.startswith("_") or not getattr(member, "__module__", "").startswith("whipcord"):
            continue
        if inspect.isfunction(member) or inspect.ismethod(member):
            yield f"{kind.__name__}.{name}", member


def public() -> dict[str, Any]:
    """Public functions and methods by their names."""
    found: dict[str, Any] = {}
    for module in MODULES:
        for name in module.__all__:
            member = getattr(module, name)
            if not getattr(member, "__module__", "").startswith("whipcord"):
                continue
            if inspect.isfunction(member):
                found[name] = member
            elif inspect.isclass(member):
                found |= dict(methods(member))
    return found


def documented(doc: str) -> set[str]:
    """The names in the section `Parameters`."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", doc, re.MULTILINE | re.DOTALL)
    if section is None:
        return set()
    heads = re.findall(r"^(\S.*)$", section[1], re.MULTILINE)
    return {name.strip().lstrip("*") for head in heads for name in head.partition(" : ")[0].split(",")}


FUNCTIONS = public()


def test_the_functions_are_found() -> None:
    assert {"load", "compare", "Case.solve", "Camera.project", "Derivatives.pull_back"} <= set(FUNCTIONS)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_every_parameter_is_documented(name: str) -> None:
    function = FUNCTIONS[name]
    doc = inspect.getdoc(function) or ""
    assert doc, f"{name} has no docstring"
    given = [each for each in inspect.signature(function).parameters if each not in ("self", "cls")]
    missing = sorted(set(given) - documented(doc))
    assert not missing, f"{name} does not document {', '.join(missing)}"


def test_every_field_is_documented() -> None:
    kinds = [kind for kind in vars(whipcord).values() if inspect.isclass(kind) and is_dataclass(kind)]
    assert len(kinds) > 20
    for kind in kinds:
        doc, source = inspect.getdoc(kind) or "", inspect.getsource(kind)
        for name in inspect.get_annotations(kind):
            if name.startswith("_"):
                continue
            # A text below the field, or an entry of the class.
            below = re.search(
                rf"^    {name}: [^\n]*\n(?:    [ )\]][^\n]*\n)*    r?\"\"\"", source, re.MULTILINE
            )
            assert below or name in documented(doc), f"{kind.__name__}.{name} is not documented"
