"""The README and the docs do what they say: their fenced blocks are run, in order, in a copy of the tree.

``sh`` and ``console`` blocks are commands (in ``console`` those after ``$``; the rest is output), ``python``
blocks are programs; other languages are left alone. Lines that call make, git to clone or pip to install are
left out. The blocks of one document share a directory, so they run in one process: with pytest-xdist,
``--dist loadfile``. A block under the line ``<!-- slow -->`` runs with the slow tests. A ``text`` block that
comes next after one of them, with nothing in between, is its output to the letter.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.places import ROOT

DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SHELL, CONSOLE, PYTHON = "sh", "console", "python"
LEFT_OUT = re.compile(r"\s*(make|git clone|pip install)\b")
MADE = shutil.ignore_patterns(".*", "target", "runs", "build", "dist", "__pycache__", "*.so")
TIMEOUT_S = 600  # a block that hangs, not one that is slow where the host has other work to do

FENCE = re.compile(
    r"^(?P<slow><!-- slow -->[ ]*\n)?"
    r"(?P<indent>[ ]*)(?P<ticks>```+)(?P<language>\w*)[^\n]*\n"
    r"(?P<body>.*?)"
    r"^(?P=indent)(?P=ticks)[ ]*$"
    r"(?:(?=\n\n```text\n(?P<output>.*?)^```$)|)",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a document."""

    document: str  # relative to the root
    line: int  # of its first line, from 1
    language: str
    body: str
    slow: bool
    output: str | None = None  # what it has to write to standard output, where the document shows that


def blocks(document: str, text: str) -> list[Block]:
    """Return the blocks of a document that can be run, in order."""
    found = []
    for match in FENCE.finditer(text):
        if match["language"] in (SHELL, CONSOLE, PYTHON):
            body = re.sub(rf"^{match['indent']}", "", match["body"], flags=re.MULTILINE)
            line = text.count("\n", 0, match.start("body")) + 1
            slow = match["slow"] is not None
            found.append(Block(document, line, match["language"], body, slow, match["output"]))
    return found


def commands(block: Block) -> str:
    """Return the shell script of a block: its commands, without those left out."""
    lines = block.body.splitlines()
    if block.language == CONSOLE:
        lines = [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]
        assert lines, f"{block.document}:{block.line}: a console block has its commands after '$ '"
    return "\n".join(line for line in lines if not LEFT_OUT.match(line))


def program(block: Block) -> list[str]:
    """Return the command line that runs a block; a shell shows each line and stops at one that fails."""
    if block.language == PYTHON:
        return [sys.executable, "-c", block.body]
    return ["bash", "-e", "-x", "-o", "pipefail", "-c", commands(block)]


def documented() -> list[Block]:
    """Return the blocks of all documents."""
    texts = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in DOCUMENTS}
    return [block for document, text in texts.items() for block in blocks(document, text)]


def case(block: Block) -> object:
    """Return the test case of a block."""
    marks = [pytest.mark.slow] if block.slow else []
    return pytest.param(block, id=f"{block.document}:{block.line}", marks=marks)


@pytest.fixture(scope="module")
def copies() -> dict[str, Path]:
    """Where each document's blocks run, filled as they come."""
    return {}


@pytest.fixture
def directory(block: Block, copies: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the copy of the tree that the blocks of this document share."""
    if block.document not in copies:
        copies[block.document] = tmp_path_factory.mktemp("docs") / "vedette"
        shutil.copytree(ROOT, copies[block.document], ignore=MADE)
    return copies[block.document]


@pytest.mark.in_order
@pytest.mark.parametrize("block", [case(block) for block in documented()])
def test_a_documented_block_runs(block: Block, directory: Path) -> None:
    binaries = Path(sys.executable).parent
    result = subprocess.run(
        program(block),
        cwd=directory,
        env=os.environ | {"PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    said = f"{result.stdout[-2000:]}\n{result.stderr[-2000:]}"
    assert result.returncode == 0, f"{block.document}:{block.line} failed\n{said}"
    if block.output is not None:
        assert result.stdout == block.output, f"{block.document}:{block.line} writes something else"


EXAMPLE = """\
# Title
```sh
git clone https://example.org/vedette && cd vedette
make explore
pip install .
vedette --version  # says which
```
<!-- slow -->
```console
$ echo one
one
$ echo two
```
  ```python
  print("indented")
  ```

```text
indented
```

```text
not run
```
```
not run either
```
"""


def test_blocks_are_found_with_their_place_language_speed_and_output() -> None:
    found = [
        (block.line, block.language, block.slow, block.output) for block in blocks("example.md", EXAMPLE)
    ]
    assert found == [
        (3, SHELL, False, None),
        (10, CONSOLE, True, None),
        (15, PYTHON, False, "indented\n"),
    ]


def test_commands_are_what_a_reader_would_type_but_for_make_clone_and_install() -> None:
    shell, console, python = blocks("example.md", EXAMPLE)
    assert commands(shell) == "vedette --version  # says which"
    assert commands(console) == "echo one\necho two"
    assert python.body == 'print("indented")\n'


def test_blocks_run_from_the_top_of_their_document_down_in_whatever_order_tests_run() -> None:
    command = [sys.executable, "-m", "pytest", "--collect-only", "--randomly-seed=1", __file__]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=TIMEOUT_S)
    run = re.findall(r"::test_a_documented_block_runs\[(.+)\]", listed.stdout)
    assert run == [f"{block.document}:{block.line}" for block in documented()]


@pytest.mark.parametrize("text", ["", "# No blocks\n", "```sh\nnever closed\n"])
def test_a_document_without_blocks_has_none(text: str) -> None:
    assert blocks("example.md", text) == []


def test_a_command_that_fails_stops_its_block_with_a_failure(tmp_path: Path) -> None:
    block = Block("example.md", 1, SHELL, "echo before\nfalse | cat\necho after\n", slow=False)
    result = subprocess.run(
        program(block), cwd=tmp_path, capture_output=True, text=True, check=False, timeout=20
    )
    assert result.returncode != 0
    assert result.stdout == "before\n"
