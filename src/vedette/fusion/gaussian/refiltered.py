"""The central filter at every robot: over shared likelihoods, and again from where late ones fall."""

from __future__ import annotations

from collections.abc import Sequence

from vedette.errors import InputError
from vedette.fusion.gaussian.information import Information, TrackMotion, check_likelihood, checked_start
from vedette.fusion.gaussian.packing import Likelihoods
from vedette.fusion.standing import Signed, signed_by
from vedette.fusion.steps import Refilter, Sparse, StepEvidence


class RefilteredTracks:
    """``Y(k) = (F Y(k-1)^-1 F' + Q)^-1 + sum_i I_i(k)``, ``y`` alike, whatever the order of arrival.

    Over ``ReplicatedSteps`` (any graph) or ``StepSums`` (a tree; scale-free). Robots that hold the same
    likelihoods hold the same tracks to the last bit. A likelihood is linearised once, by its observer, about
    its own estimate at that step; when earlier evidence arrives late, it is not linearised anew.
    """

    def __init__(
        self,
        evidence: StepEvidence[Sparse],
        likelihoods: Likelihoods,
        prior: Information,
        motion: TrackMotion,
        start: int,
    ) -> None:
        """``prior`` are the tracks at step ``start``, ahead of its evidence; the same for every robot."""
        if motion.transition.shape != prior.matrix.shape:
            raise InputError(f"F has shape {motion.transition.shape}; the prior has {prior.matrix.shape}")
        self.evidence = evidence
        self._likelihoods = likelihoods
        self._prior, self._start, self._step = checked_start(prior), start, start
        self._filter: Refilter[Information, Sparse] = Refilter(
            evidence,
            prior,
            start,
            predict=lambda track, _: motion.predict(track),
            update=self._update,
        )

    def _update(self, track: Information, _: int, total: Sparse) -> Information:
        """Add a step's evidence, or leave it out if its sum is none: all who hold the same do the same."""
        if not len(total.index):
            return track
        updated = track + self._likelihoods.tracks(total)
        return updated if updated.is_sound else track

    @property
    def signed(self) -> Signed | None:
        """The likelihoods, where they are signed."""
        return signed_by(self.evidence)

    @property
    def digest(self) -> int:
        """64 bits that agree iff the likelihoods do."""
        return self.evidence.digest

    def observe(self, step: int, likelihood: Information) -> None:
        """Share this robot's likelihood of a step, the present one or another.

        Raises InputError before the start, for a wrong shape, and for numbers above the largest stated.
        """
        if step < self._start:
            raise InputError(f"evidence of step {step} lies before the start, step {self._start}")
        check_likelihood(likelihood, self._prior)
        self.evidence.publish(step, self._likelihoods.quantise(likelihood))
        self.advance(step)

    def advance(self, step: int) -> None:
        """Go on to a step; earlier ones change nothing."""
        self._step = max(self._step, step)

    def estimate(self) -> tuple[int, Information]:
        """Return the step and the tracks given all known likelihoods up to it."""
        return self._step, self._filter.at(self._step)

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on."""
        self.evidence.set_neighbours(neighbours)

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return the next payload for a neighbour, or None if there is no news."""
        return self.evidence.outgoing(neighbour, now)

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a payload (ValueError if malformed, and nothing changes)."""
        self.evidence.receive(neighbour, payload, now)
