"""What to write instead of an argument that a function does not have."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import wraps
from types import FunctionType
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def suggests(
    function: F, advice: Callable[[str, Any], str | None] | None = None, called: str | None = None
) -> F:
    """The same function, whose ``TypeError`` for an unknown keyword argument says which one may be meant.

    `advice` may say more of an argument, by its name and value, than the names of the others tell; `called` is the
    name of the function in messages.

    >>> @suggests
    ... def solve(*, tension=None, shortening=None): ...
    >>> solve(tensoin=5)
    Traceback (most recent call last):
    TypeError: solve() has no argument 'tensoin'; did you mean 'tension'?
    >>> solve(colour="red")
    Traceback (most recent call last):
    TypeError: solve() has no argument 'colour'; its arguments are 'tension' and 'shortening'
    """
    parameters = inspect.signature(function).parameters.values()
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return function
    by_name = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    names = [p.name for p in parameters if p.kind in by_name and p.name not in ("self", "cls")]
    known = frozenset(names)
    title = called or function.__qualname__.removesuffix(".__init__")

    instead = _instead

    def checked(*args: Any, **given: Any) -> Any:
        for name in given:
            if name not in known:
                said = advice(name, given[name]) if advice else None
                raise TypeError(f"{title}() has no argument {name!r}; {said or instead(name, names)}")
        return function(*args, **given)

    # With the globals of the module that it is in, by which doctest tells whose it is.
    there = FunctionType(checked.__code__, function.__globals__, function.__name__, None, checked.__closure__)
    return wraps(function)(there)  # type: ignore[return-value]


def _instead(name: str, names: Iterable[str]) -> str:
    names = list(names)
    near = get_close_matches(name.lower(), names, n=1)
    if near:
        return f"did you mean {near[0]!r}?"
    *others, last = (repr(one) for one in names) if names else ("none",)
    return f"its arguments are {', '.join(others)} and {last}" if others else f"its only argument is {last}"
