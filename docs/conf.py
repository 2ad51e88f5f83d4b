"""The documentation site: `make docs` builds it into target/docs."""

import os
import re
import sys
from importlib.metadata import version as installed_version
from importlib.util import find_spec
from pathlib import Path

from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "Whipcord"
author = "The Whipcord developers"
copyright = author
release = installed_version("whipcord")

extensions = [
    "robot_file_keys",
    "robot_gallery",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]
exclude_patterns = ["images", "_extensions", "_pictures", "_static"]
source_suffix = {".md": "myst-nb"}

# The output of a command arrives in pieces, and one that ends within a code for bold type cannot be read.
os.environ["NO_COLOR"] = "1"

# Tutorials are run whenever the site is built; what fails in one fails the build.
nb_execution_mode = "auto"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "dollarmath"]

# The manners of NumPy: shapes and units stand in the docstrings, types in the signatures.
napoleon_google_docstring = False
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
# By the names that the sources have for them.
autodoc_type_aliases = {
    name: name for name in ("Array", "Commands", "ModelLike", "PhotoLike", "Quantity", "StationsLike", "Vector", "npt.ArrayLike")
}
python_use_unqualified_type_names = True
# The reference needs their signatures alone, and PyTorch is large.
autodoc_mock_imports = [name for name in ("torch",) if find_spec(name) is None]

nitpicky = False
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_title = f"Whipcord {release}"


def _plain_names(
    app: object, what: str, name: str, thing: object, options: object, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Autodoc leaves the names of aliases wrapped where they stand in a union."""
    plain = (text and re.sub(r"TypeAliasForwardRef\('(?:npt\.)?(\w+)'\)", r"\1", text) for text in (signature, returns))
    return next(plain), next(plain)


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-signature", _plain_names)
