"""A robot's notary: by which clock it signs."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from tests.support.net_team import TEAM, issue
from vedette.net.config import AgentConfig, LinkSettings
from vedette.net.notary import CertifiedNotary, notary_of


@pytest.fixture
def notary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> CertifiedNotary:
    """One whose host's clocks a test sets."""
    issue(tmp_path / "keys", 2)
    monkeypatch.setattr(time, "time", lambda: 1_000_000.0)
    monkeypatch.setattr(time, "monotonic", lambda: 50.0)
    config = AgentConfig(TEAM, 1, links=LinkSettings(keys="keys/robot-1"))
    made, terms = notary_of(config, tmp_path, {}, 2.0)
    assert made is not None
    assert terms == {"signatures": "P-256"}
    return made


def test_a_clock_that_is_set_back_meanwhile_takes_back_nothing_that_was_signed(
    notary: CertifiedNotary, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tile's time would lie before its robot set out, and what it can have seen by then be too little."""
    assert notary.now() == 20_000_000
    for stepped in (-3600.0, 3600.0):
        monkeypatch.setattr(time, "time", lambda stepped=stepped: 1_000_010.0 + stepped)
        monkeypatch.setattr(time, "monotonic", lambda: 60.0)
        assert notary.now() == 20_000_200


def test_robots_without_keys_have_no_notary(tmp_path: Path) -> None:
    assert notary_of(AgentConfig(TEAM, 1), tmp_path, {}, 1.0) == (None, {"signatures": "none"})
