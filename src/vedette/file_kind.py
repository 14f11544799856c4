"""What a YAML file seems to be, so that one given in another's place is called by its name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vedette.errors import InputError

# What each kind has that no other has, and what to do with it.
_KINDS: Mapping[str, tuple[set[str], str]] = {
    "map": ({"image"}, "vedette explore MAP"),
    "team file": ({"platforms"}, "vedette explore --team FILE"),
    "robot's file": ({"team", "robot"}, "vedette agent CONFIG.yaml"),
    "tracking scenario": ({"vehicles", "targets"}, "vedette track SCENARIO"),
    "search scenario": ({"vehicles", "prior"}, "vedette search SCENARIO"),
    "monitoring scenario": ({"vehicles", "field"}, "vedette monitor SCENARIO"),
    "study's spec": ({"planners"}, "vedette study SPEC"),
    "fault schedule": ({"faults"}, "--faults FILE of a mission"),
}


def check_kind(content: Any, what: str, path: Path) -> None:
    """Refuse what is plainly another kind of file than ``what`` was asked for.

    Raises:
        InputError: it is.
    """
    seems = [kind for kind, (has, _) in _KINDS.items() if isinstance(content, Mapping) and has <= {*content}]
    if seems and what in _KINDS and what not in seems:
        raise InputError(f"{path} is a {seems[0]}, not a {what}; it goes with: {_KINDS[seems[0]][1]}")
