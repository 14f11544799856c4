"""How far honest robots are from being expelled, where their poses are wrong."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

import click
import numpy as np

from bench import command
from bench.signing import KeyedTeam
from bench.table import markdown
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.trust import LEAST_SHUT, LEAST_WALL, SHARE, Comparison
from vedette.net.keys import issue_team
from vedette.sim.worlds import office

FOR_EVER = 1 << 40  # what all say is judged as if it stood from the first [0.1 s]
PERIOD = 5.0  # of looking [s]
SIDE = 14.0, 12.0  # of the office [m]


@dataclass(frozen=True)
class Margin:
    """How far two honest robots contradicted each other at worst, and whether anybody was expelled."""

    worst: Comparison  # [cells]
    expelled: bool


def measure(robots: int, seed: int, folder: Path, **body: float) -> Margin:
    """Play one mission of robots whose poses are wrong as their bodies say: ``pose_std``, ``drift``."""
    keys = issue_team("bench", folder / f"keys-{robots}-{seed}-{body}", robots, datetime.now(UTC))
    world = office(np.random.default_rng([seed, 5]), *SIDE)
    team = KeyedTeam(world, robots, seed, keys, **body)
    found, out = [Comparison(0, 0, 0)], set[int]()

    def look() -> None:
        fusions = [each.fusion for each in team.missions if isinstance(each.fusion, SignedEvidence)]
        out.update(*(fusion.out for fusion in fusions))
        found.extend(fusions[0].contradictions(FOR_EVER).values())

    team.run(look, PERIOD)
    return Margin(max(found), bool(out))


def row(robots: int, deviation: float, margins: Iterable[Margin]) -> list[str]:
    """Return the worst of some missions."""
    all_of = list(margins)
    worst = [margin.worst for margin in all_of]
    against = max(each.against for each in worst)
    shut = max(each.against / max(each.against + each.open, 1) for each in worst)
    walls = max(each.against / max(each.against + each.alike, 1) for each in worst)
    expelled = sum(margin.expelled for margin in all_of)
    figures = f"{0.1 * against:.1f} m", f"{100 * shut:.2f} %", f"{100 * walls:.2f} %"
    return [f"{100 * deviation:.0f} cm", f"{robots}", f"{len(all_of)}", *figures, f"{expelled}"]


@click.command()
@command.robots_option("3,5", least=2)
@click.option("--deviations", type=command.WholeNumbers(0), default="5,15", show_default=True, help="[cm]")
@command.seeds_option("0-4")
def margins(robots: tuple[int, ...], deviations: tuple[int, ...], seeds: tuple[int, ...]) -> None:
    """Measure how far honest robots are from being expelled; exit status 1 if one was."""
    rows = []
    with TemporaryDirectory(prefix="vedette-bench-") as folder:
        for n in robots:
            for deviation in deviations:
                played = [measure(n, seed, Path(folder), pose_std=deviation / 100.0) for seed in seeds]
                rows.append(row(n, deviation / 100.0, played))
    header = ["pose error", "robots", "missions", "wall against", "of what is open", "of walls", "expelled"]
    click.echo(markdown(header, rows, "r" * 7), nl=False)
    limit, part = f"{LEAST_SHUT:g} m and of all walls {LEAST_WALL:g} m", f"{100 / SHARE:g} %"
    click.echo(f"to be expelled it takes {limit}, and {part} of the one or the other, from two robots")
    if any(line[-1] != "0" for line in rows):
        raise SystemExit(1)


if __name__ == "__main__":
    command.run(margins, "python -m bench.margins")
