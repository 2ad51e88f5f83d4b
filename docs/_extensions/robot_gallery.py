"""The directive `robot-gallery`: a picture of every robot file of a folder, drawn when the site is built."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import whipcord
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def drawn(file: Path, picture: Path) -> list[str]:
    """The arguments of the command that draws it: with the first of the rods that takes the robot."""
    answers = []
    for model in ([], ["--model", "cosserat-disks"]):
        command = ["whipcord", "solve", str(file), *model, "--plot", str(picture)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 0:
            return model
        answers.append(done.stderr)
    raise RuntimeError(f"{file} cannot be drawn:\n" + "\n".join(answers))


def heading(text: str) -> str:
    """The first paragraph of the comment at the head of a robot file."""
    lines = [line.removeprefix("#").strip() for line in text.split("\n\n", 1)[0].splitlines() if line.startswith("#")]
    return " ".join(lines).split("  ", 1)[0]


class RobotGallery(SphinxDirective):
    """Takes the folder, relative to the sources of the site."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        folder = (Path(self.env.srcdir) / self.arguments[0]).resolve()
        pictures = Path(self.env.srcdir) / "_pictures"
        pictures.mkdir(exist_ok=True)
        return self.parse_text_to_nodes("\n\n".join(self.entries(folder, pictures)), allow_section_headings=True)

    def entries(self, folder: Path, pictures: Path) -> Iterator[str]:
        for file in sorted(folder.rglob("*.toml")):
            case = whipcord.load(file)
            if not case.robot.cables:
                continue
            self.env.note_dependency(str(file))
            name = file.relative_to(folder)
            picture = pictures / f"{'-'.join(name.with_suffix('').parts)}.svg"
            model = drawn(file, picture)
            yield f"## {case.title}"
            yield heading(file.read_text())
            yield f"```{{image}} /_pictures/{picture.name}\n:alt: {case.title}\n```"
            yield f"```sh\nwhipcord solve examples/{' '.join([str(name), *model])} --plot {picture.name}\n```"


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("robot-gallery", RobotGallery)
    return {"parallel_read_safe": True}
