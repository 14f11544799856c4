"""Fault schedules for overlays: all that happens follows from a seed.

A failing schedule replays with ``python -m tests.support.overlay_faults SEED``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.support.overlay_network import Faults, Network, random_graph

FAULTS = 6  # a schedule
PAUSE = 2.5  # between faults, at most [s]
WHOLE_AGAIN = (
    25.0  # after the last fault: the longest hold of a link, the lease, and hellos that get lost [s]
)


@dataclass
class Schedule:
    """One network and what befalls it."""

    seed: int

    def __post_init__(self) -> None:
        self.rng = np.random.default_rng((self.seed, 1))
        n = int(self.rng.integers(2, 8))
        extra = float(self.rng.choice([0.0, 0.3, 1.0]))
        self.net = Network(
            n,
            random_graph(n, self.rng, extra),
            self.seed,
            notice=bool(self.rng.integers(2)),
            talk=bool(self.rng.integers(2)),
            skew=float(self.rng.choice([0.0, 1000.0])),
        )
        self.log: list[str] = []

    def play(self) -> float:
        """Let everything happen, then heal; return how long it took to be whole again, for good [s]."""
        kinds: list[Callable[[], str]] = [
            self._partition,
            self._mend,
            self._crash,
            self._restart,
            self._freeze,
            self._one_way,
            self._flap,
            self._weather,
            self._leave,
        ]
        self.net.run(float(self.rng.uniform(0.0, 2.0)))
        for _ in range(FAULTS):
            what = kinds[int(self.rng.integers(len(kinds)))]()
            self.log.append(f"{self.net.now:.2f} s: {what}")
            self.net.run(float(self.rng.uniform(0.0, PAUSE)))
        self.net.heal()
        self.log.append(f"{self.net.now:.2f} s: healed")
        healed = self.net.now
        self.net.run_until_whole(WHOLE_AGAIN)
        self.net.faults = Faults()
        self.net.run(1.5)  # what was cut just before is noticed now, or never
        self.net.run_until_whole(WHOLE_AGAIN + healed - self.net.now)
        took, changes = self.net.now - healed, self.net.changes
        self.net.run(3.0)
        assert self.net.changes == changes, "it did not stay as it was"
        return took

    def _anybody(self) -> int:
        return int(self.rng.choice(list(self.net.nodes)))

    def _partition(self) -> str:
        part = {i for i in self.net.nodes if self.rng.random() < 0.5}
        self.net.partition(part)
        return f"partition of {part}"

    def _mend(self) -> str:
        self.net.cut.clear()
        return "links mended"

    def _crash(self) -> str:
        i = self._anybody()
        self.net.crash(i)
        return f"crash of {i}"

    def _restart(self) -> str:
        i = self._anybody()
        if self.net.nodes[i].alive:
            self.net.crash(i)
            self.net.run(float(self.rng.uniform(0.0, 4.0)))
        self.net.restart(i, int(self.rng.integers(1 << 38)))
        return f"restart of {i}"

    def _freeze(self) -> str:
        i = self._anybody()
        if self.net.nodes[i].frozen:
            self.net.thaw(i)
            return f"thaw of {i}"
        self.net.freeze(i)
        return f"freeze of {i}"

    def _one_way(self) -> str:
        i = self._anybody()
        k = int(self.rng.choice(self.net.near[i]))
        self.net.cut.add((i, k))
        return f"{k} is deaf to {i}"

    def _flap(self) -> str:
        i = self._anybody()
        k = int(self.rng.choice(self.net.near[i]))
        for _ in range(int(self.rng.integers(2, 6))):
            self.net.cut ^= {(i, k), (k, i)}
            self.net.run(float(self.rng.uniform(0.0, 1.0)))
        return f"link {i} - {k} has flapped"

    def _weather(self) -> str:
        loss, longest = float(self.rng.uniform(0.0, 0.6)), float(self.rng.choice([0.005, 0.1, 0.5]))
        self.net.faults = Faults(loss, repeat=0.1, delay=(0.001, longest))
        return f"loss {loss:.2f}, delay up to {longest} s"

    def _leave(self) -> str:
        i = self._anybody()
        if self.net.nodes[i].alive and not self.net.nodes[i].frozen:
            self.net.leave(i)
        return f"leave of {i}"


def play(seed: int) -> float:
    """Play one schedule; a failure names the command that replays it."""
    schedule = Schedule(seed)
    try:
        return schedule.play()
    except Exception as error:
        log = "\n  ".join(schedule.log)
        replay = f"replay: python -m tests.support.overlay_faults {seed}"
        raise AssertionError(f"{replay}\n  {log}\n{error}") from error


if __name__ == "__main__":
    print(f"whole again after {play(int(sys.argv[1])):.2f} s")
