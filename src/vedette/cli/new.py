"""``vedette new``: begin something of one's own from a skeleton."""

from __future__ import annotations

import keyword
import re
from importlib import resources
from importlib.util import find_spec
from pathlib import Path

import click
import yaml

from vedette.cli.options import FILE
from vedette.errors import InputError
from vedette.missions.own import skeleton
from vedette.record.files import output_directory, write_text

_TEST = '''"""The first tests of {name}: it keeps the laws, and a mission of it runs."""

from vedette.missions.own.check import check_theory
from vedette.run import DomainMission
from vedette.sim.domains import domain_of

from {name} import {title}


def test_it_keeps_the_laws_that_it_declares():
    check_theory({title})


def test_a_mission_runs():
    report = DomainMission(domain_of("{name}:{title}"), "{name}.yaml", max_time=20.0).run(compare=False)
    assert report.summary.figures
'''


@click.group()
def new() -> None:
    """Begin something of your own from a skeleton."""


@new.command()
@click.argument("name")
@click.option("--out", type=FILE, metavar="DIR", help="New folder.  [default: NAME]")
def domain(name: str, out: Path | None) -> None:
    """Begin a domain of your own: DIR gets NAME.py, its scenario NAME.yaml, and its tests.

    It runs as it is: `vedette NAME:Name NAME.yaml` in that folder. NAME is a word in small letters.
    """
    title = "".join(part.capitalize() for part in name.split("_"))
    _check_name(name, title)
    folder = Path(name) if out is None else out
    if folder.exists():
        raise InputError(f"{folder} exists; choose another folder with --out")
    output_directory(folder)
    text = resources.files("vedette.missions.own").joinpath("skeleton.py").read_text(encoding="utf-8")
    write_text(folder / f"{name}.py", text.replace("Skeleton", title).replace("skeleton", name))
    write_text(
        folder / f"{name}.yaml",
        yaml.safe_dump(_plain(skeleton.Skeleton.example), sort_keys=False, default_flow_style=None),
    )
    write_text(folder / f"test_{name}.py", _TEST.format(name=name, title=title))
    click.echo(f"cd {folder} && vedette {name}:{title} {name}.yaml && python -m pytest")


def _check_name(name: str, title: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,63}", name) or keyword.iskeyword(name):
        raise InputError(f"NAME must be a word in small letters, as my_domain; got {name!r}")
    if keyword.iskeyword(title) or title in vars(skeleton).keys() - {"Skeleton"}:
        raise InputError(f"NAME {name} would make a class {title}, which is something else; take another")
    if find_spec(name) is not None:
        raise InputError(f"there is a module {name} already, which would be found first; take another name")


def _plain(value: object) -> object:
    """Return a value as YAML has it."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    return [_plain(each) for each in value] if isinstance(value, tuple | list) else value
