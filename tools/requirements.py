"""Print what is asked for to build, to run, and by the extras named, one requirement a line.

Installing these apart from the packages lets `make` add the developers' tools without compiling again. The
reproduction runs on what Vedette brings, and has a build backend of its own.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Any


def requirements(root: Path, extras: list[str]) -> list[str]:
    """Return the requirements to build both packages and to run the project, then those of ``extras``."""
    main, reproduction = _pyproject(root), _pyproject(root / "reproduction")
    project = main["project"]
    optional = [line for extra in extras for line in project["optional-dependencies"][extra]]
    build = [line for each in (main, reproduction) for line in each["build-system"]["requires"]]
    return [*build, *project["dependencies"], *optional]


def _pyproject(folder: Path) -> dict[str, Any]:
    return tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))


if __name__ == "__main__":
    print("\n".join(requirements(Path(__file__).parents[1], sys.argv[1:])))
