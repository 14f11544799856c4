"""What a negotiation costs each platform, counted on recorded messages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vedette.negotiation import Tree
from vedette.problem import Coverage
from vedette_reproduction import teams
from vedette_reproduction.post import Recording, SparseCodec, record
from vedette_reproduction.run import ReproductionRun

TREES = ("chain", "star", "random")
SCHEMES = {"jacobi": "the paper's", "token": "token"}
FIXED, GROWING = "fixed", "grows with the team"
ITERATES = 4  # of the paper's scheme, enough for means


@dataclass(frozen=True)
class Cost:
    """What one recorded negotiation cost, by platform and sweep."""

    scheme: str
    area: str
    tree: str
    n: int
    sweeps: int
    replies: float  # most of any platform
    combinations: float  # mean over the platforms
    most_combinations: float  # of any platform
    messages: float  # mean
    most_messages: float
    total: int  # messages in all sweeps
    longest: int  # message [bytes]
    median: float  # message that holds an impact [bytes]
    seconds: float  # CPU time a platform, mean

    @property
    def total_an_iterate(self) -> float:
        """Messages of the group in an iterate of the paper's scheme, the last one's way down its stop."""
        return self.total / (self.sweeps + 1)


def measure(run: ReproductionRun, scheme: str, area: str, tree: str, n: int) -> Cost:
    """Record one negotiation and count."""
    run.tell(f"{SCHEMES[scheme]} scheme, area {area}: {tree} of {n}")
    rng = run.rng(104, n)
    team = (teams.fixed_area if area == FIXED else teams.constant_density)(n, rng)
    links = Tree.random(n, seed=rng) if tree == "random" else getattr(Tree, tree)(n)
    recording = record(
        Coverage(),
        [team.weights],
        team.candidates,
        links,
        scheme,
        max_sweeps=ITERATES if scheme == "jacobi" else 50,
        codec=None if area == FIXED else SparseCodec(len(team.weights)),
    )
    return _cost(recording, scheme, area, tree, n)


def _cost(recording: Recording, scheme: str, area: str, tree: str, n: int) -> Cost:
    sent, sweeps = recording.sent(n), recording.outcome.sweeps
    iterates = sweeps + (1 if scheme == "jacobi" else 0)  # the first one has no reply before it
    sizes = [letter.bytes for letter in recording.letters if letter.impact is not None]
    return Cost(
        scheme=SCHEMES[scheme],
        area=area,
        tree=tree,
        n=n,
        sweeps=sweeps,
        replies=max(len(own) for own in recording.replies) / sweeps,
        combinations=float(recording.combinations.mean()) / iterates,
        most_combinations=float(recording.combinations.max()) / iterates,
        messages=float(sent.mean()) / iterates,
        most_messages=float(sent.max()) / iterates,
        total=len(recording.letters),
        longest=max(sizes),
        median=float(np.median(sizes)),
        seconds=float(recording.seconds.mean()) / sweeps,
    )
