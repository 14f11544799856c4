"""Print what pyproject.toml asks for, one requirement a line: to build, to run, and of the extras named.

Installing these apart from the package lets `make` add the developers' tools without compiling again.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path


def requirements(pyproject: Path, extras: list[str]) -> list[str]:
    """Return the requirements to build and to run the project, then those of ``extras``."""
    table = tomllib.loads(pyproject.read_text(encoding="utf-8"))
    project = table["project"]
    optional = [line for extra in extras for line in project["optional-dependencies"][extra]]
    return [*table["build-system"]["requires"], *project["dependencies"], *optional]


if __name__ == "__main__":
    print("\n".join(requirements(Path(__file__).parents[1] / "pyproject.toml", sys.argv[1:])))
