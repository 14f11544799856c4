"""Write the API reference, a page a module, from the docstrings: ``api_reference.py FOLDER``."""

from __future__ import annotations

import importlib.util
import pkgutil
import sys
from pathlib import Path

import pdoc

import vedette
import vedette_reproduction

PACKAGES = (vedette, vedette_reproduction)
OPTIONAL = ("vedette.stonesoup",)  # needs its extra


def modules() -> list[str]:
    """Return the names of all modules that can be imported here, the packages themselves first."""
    tops = [package.__name__ for package in PACKAGES]
    found = [
        module.name
        for package in PACKAGES
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    ]
    compiled = "vedette._kernels"
    return [*tops, *(name for name in found if name != compiled and not _lacks_its_extra(name))]


def _lacks_its_extra(name: str) -> bool:
    return name.startswith(OPTIONAL) and importlib.util.find_spec("stonesoup") is None


def write(folder: Path) -> None:
    """Write ``index.html`` and the pages into the folder."""
    pdoc.render.configure(docformat="google", math=True, show_source=False, footer_text="Vedette")
    pdoc.pdoc(*modules(), output_directory=folder)


if __name__ == "__main__":
    write(Path(sys.argv[1]))
