"""Where a run's files go: a folder of its own, each file put in place whole."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from pathlib import Path

from vedette.errors import InputError
from vedette.maps.atomic import atomic_path

__all__ = ["atomic_path", "new_directory", "output_directory", "write_text"]


def output_directory(path: Path | str, force: bool = False, inputs: Iterable[Path] = ()) -> Path:
    """Create the folder ``path``, parents included, and return it.

    With ``force`` an existing folder is used as it is: files of the same name are replaced, others stay. None
    of the ``inputs``, files that the same command reads, may lie in it.

    Raises:
        InputError: it exists and ``force`` is not set, it holds an input, it is a file, or it cannot be
            created or written to.
    """
    path = Path(path)
    try:
        if found := next((file for file in inputs if path.is_dir() and _lies_in(file, path)), None):
            raise InputError(f"{path} holds {found.name}, which this command reads; choose another folder")
        if path.exists() and not path.is_dir():
            raise InputError(f"{path} is a file; give the name of a folder")
        if path.exists() and not force:
            raise InputError(f"{path} exists; add --force to write into it, or choose another folder")
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot create {path}: {error.strerror or error}; choose another folder") from error
    write_text(path / ".probe", "")  # a folder that takes no file must be known before a mission, not after
    (path / ".probe").unlink()
    return path


def _lies_in(file: Path, folder: Path) -> bool:
    """Tell whether a file, or the link that was given for it, is an entry of a folder."""
    return file.exists() and any(place.parent.samefile(folder) for place in (file, file.resolve()))


def new_directory(parent: Path | str, stem: str) -> Path:
    """Create ``parent/stem-001``, or the first number that is still free, and return it.

    Safe when several processes ask at once: each gets a folder of its own.

    Raises:
        InputError: ``parent`` is a file, or cannot be created or written to.
    """
    parent = output_directory(parent, force=True)
    for number in itertools.count(1):
        path = parent / f"{stem}-{number:03d}"
        try:
            path.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise InputError(
                f"cannot create {path}: {error.strerror or error}; choose another folder"
            ) from error
        return path
    raise AssertionError("unreachable: the count has no end")


def write_text(path: Path | str, text: str) -> None:
    """Write ``text`` as UTF-8, atomically."""
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
