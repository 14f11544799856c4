"""Very small reproductions: how much they compute, and parts that are made at once."""

from __future__ import annotations

import dataclasses

from PIL import Image

from vedette.study.provenance import Provenance
from vedette_reproduction.content import Section, Table, Verdict, table, wall_table
from vedette_reproduction.run import QUICK, ReproductionRun

SMALL = dataclasses.replace(
    QUICK, teams=(2, 4), largest_dense=4, trials=2, scan_offices=2, scans=4, office=(10.0, 10.0), targets=1000
)
SOURCE = Provenance("vedette reproduce --quick", "2026-01-01", "0", "abc", "a machine", "3.11")


def silent(text: str) -> None:
    """Say nothing."""


class Quiet:
    """Shows nothing; ``vedette_reproduction.reproduce.ReproductionProgress``."""

    def begin(self, number: int, of: int, name: str) -> None:
        """Show nothing."""

    def tell(self, text: str) -> None:
        """Show nothing."""

    def end(self, seconds: float) -> None:
        """Show nothing."""


def named(section: Section, name: str) -> Table:
    """Return a table of a section."""
    return next(table for table in section.tables if table.name == name)


def some_section(run: ReproductionRun) -> Section:
    """A claim with a picture and tables, at once."""
    Image.new("RGB", (4, 4)).save(run.figures / "some.png")
    chance = [("<b>", float(run.rng(1).random()))]
    tables = (table("some", "Some", ("k", "x"), chance), wall_table("clock", "Clock", ("s",), [(1.0,)]))
    return Section("c1", "C1: a < b", "said", ("found",), Verdict.IN_PART, "1 & 2", tables, ("some.png",))


def interrupted(run: ReproductionRun) -> Section:
    """Be interrupted."""
    raise KeyboardInterrupt
