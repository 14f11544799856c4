"""The reproduction is a package of its own: what is built of either, and what it needs."""

from __future__ import annotations

import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

from tests.support.places import ROOT

OWN = ROOT / "reproduction"


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run Python on these arguments."""
    return subprocess.run(
        [sys.executable, *arguments], cwd=cwd, capture_output=True, text=True, check=False, timeout=120
    )


def test_what_vedette_is_built_from_holds_its_command_and_nothing_else_of_the_reproduction(
    tmp_path: Path,
) -> None:
    done = run(
        "-m", "maturin", "sdist", "--manifest-path", "rust/Cargo.toml", "--out", str(tmp_path), cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    [archive] = tmp_path.iterdir()
    with tarfile.open(archive) as files:
        names = [Path(name).relative_to(archive.name.removesuffix(".tar.gz")) for name in files.getnames()]
    packages = {name.parts[1] for name in names if name.parts[0] == "src"}
    assert packages == {"vedette"}
    about = [name.as_posix() for name in names if "reproduc" in name.as_posix() or "paper" in name.parts]
    assert about == ["src/vedette/cli/reproduce.py"]


def test_the_reproduction_is_built_with_all_its_modules(tmp_path: Path) -> None:
    done = run("-m", "flit_core.wheel", "--outdir", str(tmp_path), cwd=OWN)
    assert done.returncode == 0, done.stderr
    [wheel] = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as files:
        built = {name for name in files.namelist() if ".dist-info/" not in name}
    modules = {path.relative_to(OWN).as_posix() for path in OWN.rglob("*.py")}
    assert len(modules) > 20
    assert built == modules | {"vedette_reproduction/py.typed"}


def test_the_reproduction_asks_for_the_vedette_of_its_own_version_alone() -> None:
    own, whole = (
        tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        for folder in (OWN, ROOT)
    )
    assert own["version"] == whole["version"]
    assert own["dependencies"] == [f"vedette=={whole['version']}"]
    assert own["requires-python"] == whole["requires-python"]


def test_it_needs_nothing_that_vedette_does_not_bring(tmp_path: Path) -> None:
    extras = "".join(f"sys.modules[{name!r}] = None; " for name in ("joblib", "pyarrow", "stonesoup"))
    done = run("-c", f"import sys; {extras}import vedette_reproduction.reproduce", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
