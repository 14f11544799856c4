"""``python -m tests.support.schedules KIND FIRST LAST JOURNAL``: seeds of one kind of trouble, or ``all``.

``faults``: a schedule of faults; the others: a member that misbehaves; all: each seed is of one kind, in
turn. What has been played is a line of the journal each, and is not played again. A failure names the commit,
and the command that replays it.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from bench.journal import append, read
from bench.machine import commit
from tests.support import bad_member, faulty_team, signed_team

TELL = 60.0  # how far it is, so often [s]

KINDS: Mapping[str, Callable[[int], object]] = {
    "faults": faulty_team.play,
    **{mode: partial(bad_member.play, mode) for mode in (*bad_member.MODES, "mutant")},
    "signed": signed_team.play,
}


@dataclass(frozen=True)
class Played:
    """One schedule, played to its end."""

    kind: str
    seed: int
    outcome: str  # "kept", or how a law was broken and how to see that again
    time_s: float  # simulated; 0 where it failed
    commit: str

    @property
    def key(self) -> tuple[str, int]:
        """What tells it from all others."""
        return self.kind, self.seed


def play(kind: str, seed: int, commit: str) -> Played:
    """Play one schedule."""
    try:
        team = KINDS[kind](seed)
    except AssertionError as error:
        return Played(kind, seed, f"at {commit}; {error}", 0.0, commit)
    assert isinstance(team, faulty_team.FaultyTeam)
    return Played(kind, seed, "kept", team.now, commit)


def wanted(kind: str, first: int, last: int) -> Iterator[tuple[str, int]]:
    """Yield what is to be played: of all kinds in turn, each seed is of one of them."""
    kinds = list(KINDS) if kind == "all" else [kind]
    return ((kinds[seed % len(kinds)], seed) for seed in range(first, last))


def main(kind: str, first: int, last: int, journal: Path) -> int:
    """Play what the journal does not have yet; return how many laws were broken by now."""
    done = read(journal, Played)
    ahead = [each for each in wanted(kind, first, last) if each not in done]
    broken = [each for each in done.values() if each.outcome != "kept"]
    began = told = time.monotonic()
    about = commit()
    for count, (each, seed) in enumerate(ahead, start=1):
        played = play(each, seed, about)
        append(journal, played)
        if played.outcome != "kept":
            broken.append(played)
            print(f"{each} {seed} {played.outcome}", flush=True)
        if (now := time.monotonic()) >= told + TELL or count == len(ahead):
            told = now
            rate = 60.0 * count / (now - began)
            print(f"{kind} up to {seed}: {count} played, {rate:.0f} a minute", flush=True)
    print(f"{len(done) + len(ahead)} in {journal}, {len(broken)} of them broke a law")
    return len(broken)


if __name__ == "__main__":
    _, which, begin, end, path = sys.argv
    sys.exit(min(main(which, int(begin), int(end), Path(path)), 1))
