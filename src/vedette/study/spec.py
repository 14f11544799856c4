"""What a study compares, as its file says it."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from vedette.errors import InputError, nearest_name
from vedette.parts import look_in
from vedette.scenario import load_scenario

COPY = "spec.yaml"  # in the folder of a study: what it was made from

Seed = Annotated[int, Meta(ge=0, le=2**32 - 1)]
Seeds = Annotated[tuple[Seed, ...], Meta(min_length=1)]
Robots = Annotated[int, Meta(ge=1, le=64)]


class Worlds(Struct, forbid_unknown_fields=True, frozen=True):
    """Generated worlds of one kind and size, one a seed."""

    kind: str  # a name of ``vedette.sim.worlds.WORLD``
    seeds: Seeds = (0,)
    width: float = 30.0  # [m]
    height: float = 20.0  # [m]
    resolution: float = 0.1  # [m]


class Map(Struct, forbid_unknown_fields=True, frozen=True):
    """A map from a file."""

    file: str  # relative to the folder of the spec
    resolution: float | None = None  # [m per pixel], of a plain image


class Spec(Struct, forbid_unknown_fields=True, frozen=True):
    """Every combination of these is a run; a list under ``platform`` or ``setup`` is one more to combine."""

    planners: Annotated[tuple[str, ...], Meta(min_length=1)]
    worlds: tuple[Worlds, ...] = ()
    maps: tuple[Map, ...] = ()
    robots: Annotated[tuple[Robots, ...], Meta(min_length=1)] = (3,)
    starts: Annotated[tuple[Literal["together", "apart"], ...], Meta(min_length=1)] = ("together",)
    seeds: Seeds = (0,)  # of the starts and of all chance in a run
    platform: (
        dict[str, Any] | tuple[dict[str, Any], ...]
    ) = {}  # fields of ``PlatformSpec``; several sets of them
    setup: dict[str, Any] = {}  # fields of ``ExploreSetup``
    reference: str = ""  # the planner that the others are compared with; the first if empty


def shipped() -> dict[str, Path]:
    """Return the specs that come with the package, by name."""
    folder = Path(str(resources.files("vedette.study") / "specs"))
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def find_spec(name: str) -> Path:
    """Return the path of a spec: a file, or the name of one that comes with the package.

    Raises:
        InputError: there is neither.
    """
    path, known = Path(name), shipped()
    if path.exists():
        return path
    if name in known:
        return known[name]
    raise InputError(
        f"there is no spec {name}; give a file, or the name of a shipped study: {nearest_name(name, known)}"
    )


def load_spec(path: Path) -> Spec:
    """Read a spec.

    Raises:
        InputError: as ``load_scenario``; or it has no worlds, or its reference is not among its planners.
    """
    spec = load_scenario(path, Spec, "study's spec")
    look_in(path.parent)
    if not spec.worlds and not spec.maps:
        raise InputError(f"{path}: nothing to explore; list generated ones under worlds, or files under maps")
    if spec.reference and spec.reference not in spec.planners:
        raise InputError(
            f"{path}: reference {spec.reference!r} is not among the planners; "
            f"{nearest_name(spec.reference, spec.planners)}"
        )
    return spec
