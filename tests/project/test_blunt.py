"""What nothing could have failed is told by its line, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.places import ROOT

TESTS = """import numpy as np
import pytest

NOTHING = []

@pytest.mark.parametrize("k", [0, 1])
def test_a(k):
    assert 1e-15 == pytest.approx(1e-14, abs=1e-12)  # told
    assert 1.0 == pytest.approx(1.0, abs=1e-12)
    assert 0.0 == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose([1e-9], [2e-9], atol=1e-6)  # told
    np.testing.assert_allclose([1e-9, 1.0], [2e-9, 1.0], atol=1e-6)
    assert np.allclose([1e-9], [2e-9])  # told
    assert all(x > 0 for x in NOTHING)  # told
    assert all(x > 0 for x in [1])
    for x in NOTHING:
        assert x  # told
    if k:
        assert k == 1

def test_b():
    with pytest.raises(ZeroDivisionError):
        1 / 0
"""


def test_what_nothing_could_have_failed_is_told(tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_toy.py").write_text(TESTS, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    words = [sys.executable, "-m", "pytest", "-p", "tests.support.blunt", "-p", "no:cacheprovider", "tests"]
    hook = ["-o", "enable_assertion_pass_hook=true"]
    done = subprocess.run(
        [*words, *hook], cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert done.returncode == pytest.ExitCode.OK, done.stdout
    told = [line.split(":")[1] for line in done.stdout.splitlines() if line.startswith("BLUNT")]
    lines = TESTS.splitlines()
    assert sorted(map(int, told)) == [k + 1 for k, line in enumerate(lines) if "# told" in line]
    refused = subprocess.run(
        words, cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert refused.returncode == pytest.ExitCode.USAGE_ERROR
    assert "enable_assertion_pass_hook" in refused.stderr
