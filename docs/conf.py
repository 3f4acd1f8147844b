"""The documentation site: pages by hand, and a reference made from the code before each build."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import generate  # noqa: E402

import compass  # noqa: E402

project = "compass"
author = copyright = "The compass developers"
version = release = compass.__version__
extensions = ["myst_parser"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "README.md"]
html_theme = "furo"
html_title = "compass"
html_static_path: list[str] = []


def setup(app: object) -> None:
    """Make the reference and the gallery anew, so that they cannot be older than the code."""
    generate.write_all(HERE)
