"""Sphinx's configuration of the documentation site; ``build.py`` lays the pages out and runs it."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import ziamath

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

_project = tomllib.loads((HERE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = "Vedette"
version = release = _project["version"]
root_doc = "README"
include_patterns = ["**.md", "**.rst"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "formulas",
    "diagrams",
    "fields",
    "names",
]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6
myst_fence_as_directive = ["mermaid"]

autodoc_class_signature = "separated"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True, "undoc-members": True, "ignore-module-all": True}
autodoc_member_order = "bysource"
autodoc_mock_imports = [  # what a robot's own Python has, and what its simulated body needs
    "builtin_interfaces",
    "geometry_msgs",
    "irsim",
    "nav2_msgs",
    "nav_msgs",
    "rclpy",
    "rosgraph_msgs",
    "sensor_msgs",
    "skimage",
    "tf2_msgs",
]

html_theme = "furo"
html_title = f"Vedette {version}"
html_static_path = [
    str(HERE / "static"),
    str(Path(ziamath.__file__).parent / "fonts" / "STIXTwoMath-Regular.ttf"),
]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
