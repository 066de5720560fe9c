"""How the pages of the documentation are built: `make docs`, offline, warnings are errors."""

import sys
from pathlib import Path

from fleet import __version__

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

project = "talking-fleet"
copyright = "the authors of talking-fleet, MIT"
release = __version__

extensions = [
    "myst_parser",  # the pages are Markdown
    "sphinx.ext.autodoc",  # the Python API, from its docstrings
    "sphinx.ext.napoleon",  # docstrings as Google writes them
    "sphinx.ext.viewcode",
    "sphinx_click",  # the command line, from its commands
]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
suppress_warnings = ["myst.header"]  # the README's pictures and headings are GitHub's

html_theme = "furo"
html_title = "talking-fleet"
html_theme_options = {"navigation_with_keys": True}
exclude_patterns = ["_build"]


def setup(app):
    """Write what is made from the code before the pages are read."""
    import generated_keys

    app.connect("builder-inited", lambda _app: generated_keys.write(HERE / "reference/keys.md"))
