"""One robot's tracks at its present step, and how those of other steps are brought there."""

from __future__ import annotations

from vedette.errors import InputError
from vedette.fusion.gaussian.information import Information, TrackMotion, check_likelihood, checked_start
from vedette.fusion.gaussian.packing import TrackPacking, check_shape
from vedette.fusion.gaussian.wire import TrackMessage
from vedette.fusion.steps.wire import check_step


class Node:
    """``(Y, y)`` at one step; prediction is common to all robots, likelihoods are added."""

    def __init__(self, prior: Information, motion: TrackMotion, start: int) -> None:
        check_step(start)
        if motion.transition.shape != prior.matrix.shape:
            raise InputError(f"F has shape {motion.transition.shape}; the prior has {prior.matrix.shape}")
        self.track = checked_start(prior)
        self.step = start
        self._motion = motion
        self._packing = TrackPacking(*prior.vector.shape)
        check_shape(self._packing)

    @property
    def digest(self) -> int:
        """64 bits that agree if step and tracks do, up to rounding."""
        return self.track.print_of(self.step)

    def observe(self, step: int, likelihood: Information) -> None:
        """Add a likelihood of the present step; InputError for an earlier one: it would need refiltering."""
        if step < self.step:
            raise InputError(f"evidence of step {step} comes at step {self.step}: too late for this fusion")
        check_likelihood(likelihood, self.track)
        self.track = self.track + likelihood

    def predict(self) -> None:
        """Go on by one step."""
        self.track = self._motion.predict(self.track)
        self.step += 1

    def forward(self, track: Information, steps: int = 1) -> Information:
        """Return tracks predicted by some steps."""
        return self._motion.predict(track, steps)

    def encoded(self) -> bytes:
        """Return the tracks' bytes."""
        return self._packing.encode(self.track)

    def decoded(self, message: TrackMessage) -> Information:
        """Return a message's tracks, predicted to the present step; ValueError if malformed or not usable."""
        tracks = self.forward(self._packing.decode(message.data), max(0, self.step - message.step))
        if not self.can_keep(tracks):
            raise ValueError("track payload: tracks that cannot be predicted")
        return tracks

    def can_keep(self, tracks: Information) -> bool:
        """Tell whether tracks at the present step are sound, and still are at the next one."""
        try:
            return tracks.is_sound and self.forward(tracks).is_sound
        except ValueError:  # numpy's LinAlgError is one
            return False
