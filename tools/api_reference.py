"""Write the API reference, a page a module, from the docstrings: ``api_reference.py FOLDER``."""

from __future__ import annotations

import importlib.util
import pkgutil
import sys
from pathlib import Path

import pdoc

import vedette

OPTIONAL = ("vedette.stonesoup",)  # needs its extra


def modules() -> list[str]:
    """Return the names of all modules that can be imported here, the package itself first."""
    found = [module.name for module in pkgutil.walk_packages(vedette.__path__, "vedette.")]
    compiled = "vedette._kernels"
    return ["vedette", *(name for name in found if name != compiled and not _lacks_its_extra(name))]


def _lacks_its_extra(name: str) -> bool:
    return name.startswith(OPTIONAL) and importlib.util.find_spec("stonesoup") is None


def write(folder: Path) -> None:
    """Write ``index.html`` and the pages into the folder."""
    pdoc.render.configure(docformat="google", math=True, show_source=False, footer_text="Vedette")
    pdoc.pdoc(*modules(), output_directory=folder)


if __name__ == "__main__":
    write(Path(sys.argv[1]))
