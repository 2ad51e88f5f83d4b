"""The Python on the pages runs as printed, and the relative links of all pages lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import matplotlib.pyplot as pyplot
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def blocks(page: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)


def test_the_python_of_the_front_page_runs() -> None:
    scope: dict[str, Any] = {}
    for block in blocks("README.md"):
        exec(block, scope)
    assert np.allclose(1e3 * scope["solution"].tip, [46.81, 76.68, 143.37], atol=0.01)
    pyplot.close("all")


def test_the_page_about_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # It writes a robot file.
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    scope: dict[str, Any] = {}
    found = blocks("docs/python.md")
    assert len(found) >= 2
    for block in found:
        exec(block, scope)
    assert (tmp_path / "robot.toml").is_file()
    assert scope["batch"].ok.all()
    pyplot.close("all")


PAGES = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md")] + sorted(
    (ROOT / "docs").rglob("*.md")
)


def anchors(page: Path) -> set[str]:
    """The anchors that a code host gives the headings of a Markdown file."""
    found: dict[str, int] = {}
    result = set()
    text = re.sub(r"^(```|~~~).*?^\1", "", page.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
    for heading in re.findall(r"^#{1,6} +(.+?)[ #]*$", text, re.MULTILINE):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        # A repeated heading is numbered from its second occurrence on.
        number = found.get(slug, 0)
        found[slug] = number + 1
        result.add(f"{slug}-{number}" if number else slug)
    return result


def broken_links(page: Path) -> list[str]:
    """The relative links of a Markdown file without a target, without an anchor in it, or without a text."""
    text = page.read_text("utf-8")
    files = re.findall(r"^```\{(?:image|figure|literalinclude)\} +(\S+)", text, re.MULTILINE)
    prose = re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.DOTALL | re.MULTILINE)
    # Formulas are indented blocks and code spans; neither has links.
    prose = re.sub(r"^ {4}.*$", "", prose, flags=re.MULTILINE)
    prose = re.sub(r"(`+).+?\1", "code", prose, flags=re.DOTALL)
    links = re.findall(r"\[([^\]]*)\]\(([^)\s]+)(?: \"[^\"]*\")?\)", prose)
    # The text of a link around a picture is the picture.
    links += [("picture", target) for target in re.findall(r"\]\([^)]*\)\]\(([^)\s]+)\)", prose)]
    links += re.findall(r'<img alt="([^"]*)" src="([^"]+)"', prose)
    broken = [f"[]({target})" for words, target in links if not words.strip()]
    for target in files + [target for _, target in links]:
        if re.match(r"[a-z][a-z0-9+.-]*:", target):
            continue
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        if not file.exists() or (anchor and (file.suffix != ".md" or anchor not in anchors(file))):
            broken.append(target)
    return broken


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_relative_links_have_targets(page: Path) -> None:
    assert broken_links(page) == []


def test_broken_links_are_found(tmp_path: Path) -> None:
    other = tmp_path / "other.md"
    other.write_text("# The `--set` option, §2\n## Twice\n## Twice\n```sh\n# no heading\n```\n")
    assert anchors(other) == {"the---set-option-2", "twice", "twice-1"}
    page = tmp_path / "page.md"
    page.write_text(
        "# Page\n[a](other.md) [a](other.md#twice-1) [a](#page) [a](https://example.org/none) ![a](other.md)\n"
        "[`a`](other.md#the---set-option-2) `[a](none.md)`\n\n    [a](none.md)\n\n```sh\n[a](none.md)\n```\n"
        '[a](none.md) ![a](none.png) <img alt="a" src="no.png"> [a](other.md#no-heading) [a](#twice) [](other.md)\n```{image} none.jpg\n```\n'
    )
    assert sorted(broken_links(page)) == [
        "#twice",
        "[](other.md)",
        "no.png",
        "none.jpg",
        "none.md",
        "none.png",
        "other.md#no-heading",
    ]


def test_the_package_and_the_crates_name_one_address() -> None:
    crates = re.search(r'^repository = "(.*)"$', (ROOT / "Cargo.toml").read_text("utf-8"), re.MULTILINE)
    urls = (
        (ROOT / "pyproject.toml").read_text("utf-8").split("[project.urls]")[1].split("[project.scripts]")[0]
    )
    named = re.findall(r'"(https://.*)"', urls)
    assert crates is not None and len(named) == 3
    assert all(url.startswith(crates[1]) for url in named)


NAMED = re.compile(r"`((?:crates|docs|examples|python)/[\w./-]+)`")


def test_the_files_that_pages_name_are_there() -> None:
    named = {(page.name, path) for page in PAGES for path in NAMED.findall(page.read_text("utf-8"))}
    assert len(named) > 20
    missing = sorted((page, path) for page, path in named if not (ROOT / path).exists())
    assert not missing
