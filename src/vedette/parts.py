"""Parts of somebody's own: found by the name of an entry point or as ``module:NAME``, told of in one line."""

from __future__ import annotations

import hashlib
import importlib
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, wraps
from importlib.metadata import EntryPoint, entry_points
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, TypeVar

from vedette.errors import InputError, PartError, nearest_name

T = TypeVar("T")

Check = Callable[[Any], object]  # raises TypeError or ValueError for what a method must not return

_FOLDERS: dict[str, None] = {}  # looked in beside the environment, in the order they were named
_LOADED: set[Path] = set()  # files of own modules, folders of own packages


@dataclass(frozen=True)
class PartKind(Generic[T]):
    """A kind of part: the house's by name, others' by the name of an entry point, or as ``module:NAME``."""

    group: str  # of the entry points: ``planners`` for those of ``vedette.planners``
    word: str  # what messages call one
    house: Mapping[str, T]
    wrong: Callable[[Any], str | None]  # why a thing is none; None: it is one
    page: str  # of the docs: what one must be

    @property
    def names(self) -> list[str]:
        """All that go by a name."""
        return [*self.house, *(name for name in _entries(self.group) if name not in self.house)]

    def find(self, name: str) -> T:
        """Return the part of this name.

        Raises:
            InputError: there is none, its module cannot be imported, or it is something else.
        """
        if name in self.house:
            return self.house[name]
        if not isinstance(name, str) or not (is_reference(name) or name in _entries(self.group)):
            raise InputError(f"unknown {self.word} {name!r}; {nearest_name(str(name), self.names)}")
        try:
            part: T = load(self._reference(name))
        except InputError as error:
            raise InputError(f"{self.word}: {error}") from error
        wrong = self.wrong(part)
        if wrong is not None:
            raise InputError(f"{self.word} {name}: {wrong}; see {self.page}")
        return part

    def fingerprint(self, name: str) -> str | None:
        """Return 12 hexadecimal digits that change with the code of an own part; None: it is the house's."""
        if name in self.house:
            return None
        return _fingerprint(importlib.import_module(self._reference(name).partition(":")[0]))

    def _reference(self, name: str) -> str:
        return name if is_reference(name) else _entries(self.group)[name].value


def named(group: str) -> list[str]:
    """Return the names of the entry points of a group."""
    return list(_entries(group))


def is_reference(name: object) -> bool:
    """Tell whether a name is ``module:NAME``."""
    return isinstance(name, str) and all(name.partition(":"))


def look_in(folder: Path) -> None:
    """Look for modules in a folder too, after the environment: for what is named in files that lie in it."""
    place = str(folder.resolve())
    _FOLDERS[place] = None
    if place not in sys.path:
        sys.path.append(place)


def folders() -> list[str]:
    """Return the folders that are looked in beside the environment, for processes that shall do so too."""
    return list(_FOLDERS)


def finding_parts() -> dict[str, str]:
    """Return the environment of a process that shall look for modules where this one does."""
    places = [*folders(), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {"PYTHONPATH": os.pathsep.join(places)} if folders() else {}


def load(reference: str) -> Any:
    """Return what ``module:NAME`` names.

    Raises:
        InputError: the module cannot be imported, or has nothing of this name.
    """
    module_name, _, name = reference.partition(":")
    try:
        module = importlib.import_module(module_name)
    except (Exception, SystemExit) as error:
        missing = isinstance(error, ModuleNotFoundError)
        remedy = "install it, or put it beside the file" if missing else "mend it"
        stem = module_name.split(".")[-1]
        at = _place([frame for frame in _frames(error) if Path(frame.filename).stem == stem])
        raise InputError(f"cannot import {module_name}: {said(error)}{at}; {remedy}") from error
    if module.__file__ is not None:
        _LOADED.add(Path(module.__file__).parent if module.__package__ else Path(module.__file__))
    if not hasattr(module, name):
        own = [each for each in vars(module) if not each.startswith("_")]
        raise InputError(f"{module_name} has no {name!r}; {nearest_name(name, own)}")
    return getattr(module, name)


def said(error: BaseException) -> str:
    """Return an error in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


@contextmanager
def telling(what: str) -> Iterator[None]:
    """Raise PartError, which names ``what`` and the line of its file, for whatever is raised within."""
    try:
        yield
    except InputError as error:
        raise PartError(str(error)) from error
    except (Exception, SystemExit) as error:
        at = _place([frame for frame in _frames(error) if _is_own(Path(frame.filename))])
        raise PartError(f"{what}: {said(error)}{at}") from error


def number(returned: Any) -> None:
    """Raise TypeError or ValueError for what is no finite number."""
    if not isfinite(returned):
        raise ValueError(f"gives {returned}; a finite number is asked for")


def numbers(returned: Any) -> None:
    """Raise TypeError or ValueError for what has another thing than finite numbers in it."""
    for each in returned:
        number(each)


def told(part: T, checks: Mapping[str, Check], name: str) -> T:
    """Return the part, whose methods raise PartError, which names them, where they raise.

    Args:
        part: whose attributes can be set.
        checks: by method, of what it returns.
        name: of the part, as messages have it.
    """
    for method, check in checks.items():
        setattr(part, method, _telling(getattr(part, method), check, f"{name}: {method}"))
    return part


def _telling(method: Callable[..., Any], check: Check, what: str) -> Callable[..., Any]:
    @wraps(method)
    def called(*given: Any, **named: Any) -> Any:
        with telling(what):
            returned = method(*given, **named)
            check(returned)
        return returned

    return called


def _frames(error: BaseException) -> traceback.StackSummary:
    return traceback.extract_tb(error.__traceback__)


def _place(frames: Sequence[traceback.FrameSummary]) -> str:
    """Say in which line of an own module an error arose; nothing if in none."""
    return f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""


def _is_own(file: Path) -> bool:
    return not _LOADED.isdisjoint((file, *file.parents))


@cache
def _entries(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of ``vedette.GROUP`` that installed packages have."""
    return {entry.name: entry for entry in entry_points(group=f"vedette.{group}")}


@cache
def _fingerprint(module: ModuleType) -> str:
    """Return 12 digits of a module's code, and of all beside it that it uses."""
    digest = hashlib.sha256()
    for path in sorted(_files(module)):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def _files(module: ModuleType) -> set[Path]:
    """Return the files of a module, of its package, and of the modules in its folder that it uses."""
    if module.__file__ is None:
        return set()
    folder, found, left = Path(module.__file__).parent, set[Path](), [module]
    if module.__package__:
        return set(folder.rglob("*.py"))
    while left:
        each = left.pop()
        file = getattr(each, "__file__", None)
        if file is None or Path(file).parent != folder or Path(file) in found:
            continue
        found.add(Path(file))
        left += [sys.modules[name] for name in map(_module_of, vars(each).values()) if name in sys.modules]
    return found


def _module_of(thing: object) -> str:
    """Return the name of a module, or of the one that a thing comes from."""
    return str(thing.__name__ if isinstance(thing, ModuleType) else getattr(thing, "__module__", ""))
