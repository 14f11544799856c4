"""A robot's body that is a Python class of somebody's own, as the robot's file names it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msgspec import Struct

from vedette.agent.body import Body
from vedette.errors import InputError
from vedette.net.own_body import CheckedBody
from vedette.parts import PartKind, is_reference, look_in, said
from vedette.team import PlatformSpec

BODY: PartKind[Any] = PartKind(
    "bodies",
    "body.own.make",
    {},
    lambda part: None if callable(part) else f"is {type(part).__name__}, not a class",
    "docs/how-to/own-body.md",
)
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
                f"body.own: {self.make} cannot be made: {said(error)}; mend body.own.settings"
            ) from error
        if lacking:
            raise InputError(
                f"body.own: what {self.make} makes is no body: it lacks {', '.join(lacking)}; "
                "see docs/how-to/own-body.md"
            )
        return CheckedBody(self.make, body, spec)

    def _make(self, folder: Path) -> Any:
        if not (is_reference(self.make) or self.make in BODY.names):
            raise InputError(f"body.own.make: {self.make!r} must be module:NAME, as my_robot:MyRobot")
        look_in(folder)
        return BODY.find(self.make)
