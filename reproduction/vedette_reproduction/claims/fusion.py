"""Claim C10: control and data fusion by the same messages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.negotiation import Tree
from vedette.problem import LogDet, Objective
from vedette_reproduction.content import Section, Verdict, table
from vedette_reproduction.links import sweep, team_on
from vedette_reproduction.post import record
from vedette_reproduction.run import ReproductionRun

Float = NDArray[np.float64]
SENSORS = 6  # platforms in the Gaussian example
D = 4  # its state: x, y, vx, vy


def c10(run: ReproductionRun) -> Section:
    """Let the same code carry information for control and for fusion, and compare with one central filter."""
    rows, worst, wrong_z, predicted = _fusion(run)
    prior_loss = _unequal_priors(run)
    control, fusion = rows[0], rows[1]
    holds = worst < 1e-9 and control[2] == fusion[2]
    return Section(
        "c10",
        "C10: for Gaussians, control and data fusion communicate in the same form; priors must be equal "
        "first",
        "For the Gaussian case the decentralised control algorithm has the same form as a DDF algorithm, "
        "which sends information matrix and vector after an observation. The posterior entropy does not "
        "depend on what is observed. The prior must be synchronised by DDF over the same network before "
        "the control can start.",
        (
            f"{SENSORS} platforms with range, bearing and position sensors, linearised as in eq. (18), on "
            "random trees. The code that adds up candidates' information also added up [I | i] after the "
            f"observations, {fusion[2]} messages for {control[2]}, {fusion[3]} bytes of numbers for "
            f"{control[3]}. Everybody's posterior equals that of one central Kalman filter in covariance "
            f"form to {worst:.0e}, and the entropy predicted before the observation equals the one after it "
            f"to {predicted:.0e}, for every measurement drawn (eq. (22)).",
            "An erratum: with h(x) = a + Hx, as printed under (18), eq. (21) needs z − a in place of z. "
            f"Taken as printed it is off by {wrong_z:.2f} standard deviations here, root mean square.",
            "Where priors differ, each maximises another J. Here every platform knew something of its own "
            "that the others had not been told: the choices that came out were worth "
            f"{100 * prior_loss:.1f} % less, on the prior of all, than with the priors shared first.",
        ),
        Verdict.HOLDS if holds else Verdict.FAILS,
        f"same code, {control[2]} messages each; fusion equals the central filter to {worst:.0e}; unequal "
        f"priors cost {100 * prior_loss:.1f} %",
        (
            table(
                "c10_form",
                "One sweep of control and of fusion",
                ("what", "numbers in a message", "messages", "bytes of numbers"),
                rows,
            ),
            table(
                "c10_checks",
                "Against one central filter",
                ("check", "value"),
                [
                    ("largest difference from the central filter's mean and covariance", worst),
                    ("largest difference of predicted and actual entropy [nat]", predicted),
                    ("error of eq. (21) as printed [standard deviations]", wrong_z),
                    ("share of the value lost with unequal priors", prior_loss),
                ],
            ),
        ),
    )


@dataclass(frozen=True, eq=False)
class Look:
    """A linearised measurement ``z = a + H x + noise`` (paper, eq. (18))."""

    offset: Float  # a, (m,)
    jacobian: Float  # H, (m, D)
    noise: Float  # R, (m, m)

    @property
    def information(self) -> Float:
        """``H' R^-1 H`` (paper, eq. (25))."""
        return np.asarray(self.jacobian.T @ np.linalg.solve(self.noise, self.jacobian))

    def vector(self, z: Float) -> Float:
        """``H' R^-1 (z - a)``: eq. (21), corrected."""
        return np.asarray(self.jacobian.T @ np.linalg.solve(self.noise, z - self.offset))


class AugmentedSum(Objective[Float, Float]):
    """``[I | i]`` under addition: what fusion adds up; the value is of no interest."""

    def nothing(self, belief: Float) -> Float:
        """Return zeros."""
        return np.zeros((D, D + 1))

    def combine(self, a: Float, b: Float) -> Float:
        """``a + b``."""
        return a + b

    def value(self, belief: Float, impact: Float) -> float:
        """Return 0."""
        return 0.0


def random_look(rng: np.random.Generator) -> Look:
    """Return a measurement of position of one or two components about a random line of sight."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    sight = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    rows = sight[: int(rng.integers(1, 3))]
    jacobian = np.hstack((rows, np.zeros_like(rows)))
    noise = np.diag(rng.uniform(0.05, 2.0, len(rows)))
    return Look(rng.uniform(-5.0, 5.0, len(rows)), jacobian, noise)


def central_update(
    mean: Float, covariance: Float, looks: Sequence[Look], zs: Sequence[Float]
) -> tuple[Float, Float]:
    """One Kalman filter that is given all measurements, one after the other, in covariance form."""
    for look, z in zip(looks, zs, strict=True):
        h = look.jacobian
        gain = covariance @ h.T @ np.linalg.inv(h @ covariance @ h.T + look.noise)
        mean = mean + gain @ (z - look.offset - h @ mean)
        covariance = (np.eye(D) - gain @ h) @ covariance
    return mean, covariance


def _fusion(run: ReproductionRun) -> tuple[list[tuple[str, int, int, int]], float, float, float]:
    """Return the table's rows, the worst error, that of eq. (21) as printed, that of predicted entropy."""
    worst = predicted = 0.0
    printed = []
    messages = {"control": 0, "fusion": 0}
    for k in range(run.scale.trials):
        rng = run.rng(110, k)
        tree = Tree.random(SENSORS, seed=rng)
        root = rng.standard_normal((D, D))
        covariance = root @ root.T + 0.5 * np.eye(D)
        prior, mean = np.asarray(np.linalg.inv(covariance), np.float64), rng.standard_normal(D)
        options = [[random_look(rng) for _ in range(5)] for _ in range(SENSORS)]
        impacts = [[look.information for look in own] for own in options]
        messages["control"] = sweep(team_on(tree, LogDet(), prior, impacts, [0] * SENSORS), tree)
        agreed = record(LogDet(), [prior], impacts, tree, "token")
        looks = [options[i][choice] for i, choice in enumerate(agreed.choice) if choice is not None]
        truth = rng.multivariate_normal(mean, covariance)
        zs = [rng.multivariate_normal(look.offset + look.jacobian @ truth, look.noise) for look in looks]
        sums = [
            np.column_stack((look.information, look.vector(z))) for look, z in zip(looks, zs, strict=True)
        ]
        members = team_on(tree, AugmentedSum(), prior, [[one] for one in sums], [0] * SENSORS)
        messages["fusion"] = sweep(members, tree)
        central = central_update(mean, covariance, looks, zs)
        for member in members:
            total = member.links.others() + member.seat.impact
            posterior = np.linalg.inv(prior + total[:, :D])
            state = posterior @ (prior @ mean + total[:, D])
            worst = max(
                worst, float(np.abs(state - central[0]).max()), float(np.abs(posterior - central[1]).max())
            )
        gain = LogDet().value(prior, np.sum([look.information for look in looks], axis=0))
        after = 0.5 * (np.linalg.slogdet(covariance)[1] - np.linalg.slogdet(central[1])[1])
        predicted = max(predicted, abs(gain - float(after)))
        naive = sum(
            look.jacobian.T @ np.linalg.solve(look.noise, z) for look, z in zip(looks, zs, strict=True)
        )
        information = prior + sum(look.information for look in looks)
        off = np.linalg.solve(information, prior @ mean + naive) - central[0]
        printed.append(float(off @ information @ off) / D)
    rows = [
        ("control: I of the present choice", D * D, messages["control"], D * D * 8),
        ("fusion: I and i of the observation", D * (D + 1), messages["fusion"], D * (D + 1) * 8),
    ]
    return rows, worst, float(np.sqrt(np.mean(printed))), predicted


def _unequal_priors(run: ReproductionRun) -> float:
    """Return the mean share of the value that is lost if everybody plans on a prior of its own."""
    losses = []
    objective = LogDet()
    for k in range(5 * run.scale.trials):
        rng = run.rng(110, 1, k)
        tree = Tree.random(SENSORS, seed=rng)
        secrets = [5.0 * random_look(rng).information for _ in range(SENSORS)]
        common = 0.2 * np.eye(D)
        shared = common + sum(secrets)
        impacts = [[random_look(rng).information for _ in range(5)] for _ in range(SENSORS)]
        own = [common + secret for secret in secrets]
        apart = record(objective, own, impacts, tree, "token")
        together = record(objective, [shared], impacts, tree, "token")

        def worth(choice: Sequence[int | None], impacts: Any = impacts, shared: Float = shared) -> float:
            chosen = sum(impacts[i][c] for i, c in enumerate(choice) if c is not None)
            return objective.value(shared, chosen)

        losses.append(1.0 - worth(apart.choice) / worth(together.choice))
    return float(np.mean(losses))
