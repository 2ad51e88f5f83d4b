"""The directive `robot-file-keys`: every key of a robot file, from the schema that `whipcord schema` writes."""

import json
import subprocess
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

Node = dict[str, Any]


def kinds_of(node: Node) -> Iterator[str]:
    """What a value may be: quantities by name, the names of a choice, or a plain type."""
    if "$ref" in node:
        yield node["$ref"].rsplit("/", 1)[1].replace("-", " ")
    elif "enum" in node:
        yield " or ".join(f'`"{value}"`' for value in node["enum"])
    elif "const" in node:
        yield f'`"{node["const"]}"`'
    elif node.get("type") == "array":
        yield "list of " + " or ".join(dict.fromkeys(kinds_of(node["items"])))
    elif "anyOf" in node:
        for choice in node["anyOf"]:
            yield from kinds_of(choice)
    elif "type" in node:
        yield {"object": "table", "string": "text", "boolean": "true or false"}.get(node["type"], node["type"])


def tables_in(node: Node) -> Iterator[Node]:
    """The tables that a key holds itself: one, or one of several kinds."""
    if "oneOf" in node:
        yield from node["oneOf"]
    elif "properties" in node:
        yield node


def describe(name: str, node: Node) -> Iterator[str]:
    """The table `name` and the tables within it, as Markdown."""
    array = node.get("type") == "array"
    title = f"[[{name}]]" if array else f"[{name}]"
    node = node["items"] if array else node
    for table in tables_in(node):
        kind = table["properties"].get("kind", {}).get("const")
        yield f"### `{title}`" + (f", `kind = \"{kind}\"`" if kind else "")
        yield table.get("description", "")
        required = table.get("required", [])
        rows = ["| key | what | value |", "|---|---|---|"]
        for key, value in table["properties"].items():
            if key == "kind":
                continue
            what = value.get("description", "").replace("|", "\\|") + (" **Needed.**" if key in required else "")
            rows.append(f"| `{key}` | {what} | {', or '.join(dict.fromkeys(kinds_of(value)))} |")
        yield "\n".join(rows)
        for key, value in table["properties"].items():
            inner = value.get("items", {}) if value.get("type") == "array" else value
            if any(tables_in(inner)):
                yield from describe(f"{name}.{key}", value)


def units(schema: Node) -> str:
    """The quantities, as Markdown."""
    rows = ["| quantity | how it is written |", "|---|---|"]
    for name, node in schema["$defs"].items():
        rows.append(f"| {name.replace('-', ' ')} | {node['description'].replace('|', chr(92) + '|')} |")
    return "\n".join(rows)


class RobotFileKeys(SphinxDirective):
    """Takes no arguments."""

    def run(self) -> list[nodes.Node]:
        schema = json.loads(subprocess.run(["whipcord", "schema"], check=True, capture_output=True, text=True).stdout)
        top = schema["properties"]
        plain = {key: value for key, value in top.items() if not any(tables_in(value.get("items", value)))}
        parts = ["## Top level", schema["description"], "| key | what |\n|---|---|\n" + "\n".join(
            f"| `{key}` | {value['description']} |" for key, value in plain.items()
        )]
        for key, value in top.items():
            if key not in plain:
                parts += describe(key, value)
        parts += ["## Quantities", units(schema)]
        return self.parse_text_to_nodes("\n\n".join(parts), allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("robot-file-keys", RobotFileKeys)
    return {"parallel_read_safe": True}
