"""Pictures in notebooks."""

from __future__ import annotations


def picture(svg: str, below: str = "") -> str:
    """A picture that is as wide as there is room, but not wider than reads well."""
    return f'<div style="max-width:620px">{svg}{below}</div>'
