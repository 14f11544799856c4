"""A robot's body that is a Python class of somebody's own, as the robot's file names it."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msgspec import Struct

from vedette.agent.body import Body
from vedette.errors import InputError, nearest_name
from vedette.net.own_body import CheckedBody
from vedette.team import PlatformSpec

PARTS = ("hull", "pose", "figures", "sense", "carry_out", "stop")  # of a body


class OwnSettings(Struct, forbid_unknown_fields=True, frozen=True):
    """Which class is the body."""

    make: str  # module:NAME, called with the robot's PlatformSpec; the module may lie beside the file
    settings: Mapping[str, Any] = {}  # handed to it by keyword

    def body(self, spec: PlatformSpec, folder: Path) -> Body:
        """Return the body; modules are looked for in the environment, then in ``folder``.

        Raises:
            InputError: there is no such class, it cannot be made with these settings, or is no body.
        """
        make = self._make(folder)
        try:
            body: Body = make(spec, **self.settings)
            lacking = [part for part in PARTS if not hasattr(body, part)]
        except InputError:
            raise
        except Exception as error:
            raise InputError(
                f"body.own: {self.make} cannot be made: {_said(error)}; mend body.own.settings"
            ) from error
        if lacking:
            raise InputError(
                f"body.own: what {self.make} makes is no body: it lacks {', '.join(lacking)}; "
                "see docs/how-to/own-body.md"
            )
        return CheckedBody(self.make, body, spec)

    def _make(self, folder: Path) -> Any:
        module_name, _, name = self.make.partition(":")
        if not (module_name and name):
            raise InputError(f"body.own.make: {self.make!r} must be module:NAME, as my_robot:MyRobot")
        if str(folder) not in sys.path:
            sys.path.append(str(folder))
        try:
            module = importlib.import_module(module_name)
        except Exception as error:
            raise InputError(
                f"body.own.make: cannot import {module_name}: {_said(error)}; install it, or put it beside "
                "the file"
            ) from error
        make = getattr(module, name, None)
        if not callable(make):
            names = [each for each in vars(module) if callable(getattr(module, each))]
            raise InputError(f"body.own.make: {module_name} has no {name!r}; {nearest_name(name, names)}")
        return make


def _said(error: Exception) -> str:
    """Return an error in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
