"""What a tracking vehicle tells the operator: its tracks, and which targets it sees."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, cast

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette import wire
from vedette.agent import Agent, FlightBehaviour
from vedette.domains.tracking.belief import Tracks
from vedette.missions.track.scenario import MOST_TARGETS, TrackScenario
from vedette.missions.track.tracking import Tracking
from vedette.net.gather import figures_of, path_of
from vedette.net.report import FARTHEST, MOST_BYTES, Condition, Count, Real
from vedette.record.track.log import TrackSample
from vedette.record.track.observer import TrackView, ahead

Floats = Annotated[bytes, Meta(max_length=MOST_BYTES)]  # little-endian doubles


class TracksContent(msgspec.Struct, frozen=True, array_like=True, tag=3):
    """A vehicle's tracks in information form, at a step of their own."""

    step: Count
    matrix: Floats  # (T, 4, 4)
    vector: Floats  # (T, 4)
    skipped: Count  # measurements that it left out
    seen: Annotated[tuple[Count, ...], Meta(max_length=MOST_TARGETS)]  # targets, by its latest look
    dt: Annotated[float, Meta(gt=0.0, le=FARTHEST)]  # of a step [s]
    origin: tuple[Real, Real]  # that the vectors are relative to [m], team frame


_CONTENTS: msgspec.msgpack.Decoder[TracksContent] = msgspec.msgpack.Decoder(TracksContent)
_encode = msgspec.msgpack.Encoder().encode


@dataclass(frozen=True, eq=False)
class TrackTeller:
    """Tells what an agent knows of the targets; ``vedette.net.witness.Teller``."""

    agent: Agent
    scenario: TrackScenario
    known: None = None

    def path(self, now: float) -> NDArray[np.float64]:
        """Return where the vehicle will fly, to the end of its plan."""
        agent, flight = self.agent, cast(FlightBehaviour, self.agent.behaviour).flight
        if agent.pose is None:
            return np.empty((0, 2))
        pose = np.array((agent.pose.x, agent.pose.y, agent.pose.heading))
        return ahead(flight, pose, self.scenario, agent.robot, int(now / self.scenario.step))

    def content(self, now: float) -> bytes:
        """Return its tracks."""
        mission = cast(Tracking, self.agent.mission)
        tracks = mission.tracks()
        matrix, vector = tracks.Y.astype("<f8").tobytes(), tracks.y.astype("<f8").tobytes()
        count = mission.skipped, mission.seen
        return _encode(TracksContent(tracks.k0, matrix, vector, *count, tracks.dt, tracks.origin))


def view_of(condition: Condition, payload: bytes, prior: Tracks) -> TrackView:
    """Return what a vehicle reports, of targets known as ``prior`` at step 0.

    Raises:
        ValueError: malformed, or of other targets.
    """
    told = read_content(payload)
    matrix = _floats(told.matrix, prior.Y.shape)
    vector = _floats(told.vector, prior.y.shape)
    at = condition.x, condition.y, condition.heading
    seen = tuple(target for target in told.seen if target < len(prior.models))
    return TrackView(
        TrackSample(*at, condition.state, True, path_of(condition), seen),
        replace(prior, k0=told.step, Y=matrix, y=vector),
        told.skipped,
        figures_of(condition),
    )


def read_content(payload: bytes) -> TracksContent:
    """Return a vehicle's tracks; their numbers are still packed.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_CONTENTS, payload, "report")


def moments(told: TracksContent) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means ``(T, 4)`` [m, m/s] and covariances ``(T, 4, 4)``, team frame.

    Raises:
        ValueError: no information, or none of such a size.
    """
    targets = len(told.vector) // 32
    matrix, vector = _floats(told.matrix, (targets, 4, 4)), _floats(told.vector, (targets, 4))
    try:
        covariances: NDArray[np.float64] = np.linalg.inv(matrix).astype(np.float64)
    except np.linalg.LinAlgError:
        raise ValueError("report of tracks without information") from None
    means = np.einsum("tij,tj->ti", covariances, vector)
    means[:, :2] += told.origin
    return means, covariances


def _floats(data: bytes, shape: tuple[int, ...]) -> NDArray[np.float64]:
    if len(data) != 8 * int(np.prod(shape)):
        raise ValueError(f"report of tracks of {len(data)} bytes, not of shape {shape}")
    values = np.frombuffer(data, "<f8").astype(np.float64).reshape(shape)
    if not np.isfinite(values).all():
        raise ValueError("report of tracks that are not finite")
    return values
