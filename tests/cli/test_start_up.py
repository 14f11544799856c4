"""Nobody who asks for help waits for what only results need."""

from __future__ import annotations

import subprocess
import sys

import click
import pytest

from vedette.cli import COMMANDS, commands
from vedette.sim.domains import DOMAINS

SLOW = {"matplotlib", *(f"scipy.{part}" for part in ("integrate", "linalg", "ndimage", "optimize", "stats"))}
_ASK = """
import sys
from vedette.cli import main
sys.argv = ["vedette", *{words!r}, "--help"]
try:
    main()
finally:
    print(*sys.modules, file=sys.stderr)
"""


def imported(*words: str) -> set[str]:
    """What a process has imported that printed the help of a command."""
    asked = subprocess.run(
        [sys.executable, "-c", _ASK.format(words=words)], capture_output=True, text=True, check=True
    )
    assert asked.stdout.startswith("Usage: vedette")
    return set(asked.stderr.split())


def test_the_list_of_commands_imports_neither_a_command_nor_an_array() -> None:
    modules = imported()
    assert "click" in modules
    assert not {"numpy", *(f"vedette.cli.{name}" for name in COMMANDS)} & modules


@pytest.mark.parametrize("name", COMMANDS)
def test_a_commands_help_imports_no_pictures_and_none_of_scipy(name: str) -> None:
    modules = imported(name)
    assert f"vedette.cli.{'domain' if name in DOMAINS else name}" in modules
    assert modules & SLOW == set()


def test_a_commands_line_in_the_list_is_a_sentence_and_every_command_has_one() -> None:
    context = click.Context(commands)
    for name, line in COMMANDS.items():
        assert commands.get_command(context, name).name == name  # type: ignore[attr-defined]
        assert line[0].isupper()
        assert line.endswith(".")
