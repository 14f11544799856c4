"""Tests run in a random order: the seed that repeats it is told, and what has to be in order stays so."""

from __future__ import annotations

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the cases marked ``in_order`` back in order, in the places that pytest-randomly gave to them."""
    places = [k for k, item in enumerate(items) if item.get_closest_marker("in_order")]
    for k, item in zip(places, sorted((items[k] for k in places), key=_written), strict=True):
        items[k] = item


def _written(item: pytest.Item) -> tuple[str, int, list[int]]:
    """Return what sorts cases as they are written: file, line, and place among the parameters."""
    assert isinstance(item, pytest.Function)
    file, line, _ = item.location
    return file, line or 0, list(item.callspec.indices.values())


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Tell the seed of the order at the end, where a failure is read; ``-q`` hides it from the top."""
    if config.pluginmanager.hasplugin("randomly"):
        seed = config.getoption("randomly_seed")
        terminalreporter.write_line(f"order and chance of this run: --randomly-seed={seed}")
