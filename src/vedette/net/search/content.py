"""What a searching vehicle tells the operator: where it takes the target to be, and where it has looked."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple, cast

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette import wire
from vedette.agent import Agent, FlightBehaviour
from vedette.agent.flight import step_of
from vedette.domains.search.belief import TargetPdf
from vedette.maps import GridFrame
from vedette.missions.search.case import SearchCase
from vedette.missions.search.searching import Declared, Searching
from vedette.net.gather import figures_of, path_of
from vedette.net.report import FARTHEST, MOST_BYTES, Condition, Count, Real, inflated
from vedette.record.search.log import SearchSample
from vedette.record.search.observer import SearchView, ahead

MOST_LOOKS = 64  # in a step
MOST_SIDE = 1 << 13  # of the area [cells]


class DeclaredPlace(NamedTuple):
    """Where the target is declared to be, as ``vedette.missions.search.searching.Declared``."""

    x: Real  # [m], team frame
    y: Real
    time: Real  # [s]
    certain: bool


class StepLooks(NamedTuple):
    """From where a vehicle looked in a step."""

    step: Count
    poses: Annotated[tuple[tuple[Real, Real, Real], ...], Meta(max_length=MOST_LOOKS)]  # [m, m, rad]


class PdfContent(msgspec.Struct, frozen=True, array_like=True, tag=4):
    """A vehicle's belief, and its latest looks."""

    step: Count
    mass: Annotated[bytes, Meta(max_length=MOST_BYTES)]  # (R, C) little-endian floats, deflated
    declared: DeclaredPlace | None
    goal: tuple[Real, Real] | None  # where it will search after its plan [m]
    looks: Annotated[tuple[StepLooks, ...], Meta(max_length=MOST_LOOKS)]
    outside: Annotated[float, Meta(ge=0.0, le=1.0)]  # probability that the target has left
    rows: Annotated[int, Meta(ge=1, le=MOST_SIDE)]
    cols: Annotated[int, Meta(ge=1, le=MOST_SIDE)]
    resolution: Annotated[float, Meta(gt=0.0, le=FARTHEST)]  # [m]
    x: Real  # of the area's corner [m], team frame
    y: Real


_CONTENTS: msgspec.msgpack.Decoder[PdfContent] = msgspec.msgpack.Decoder(PdfContent)
_encode = msgspec.msgpack.Encoder().encode


@dataclass(frozen=True, eq=False)
class SearchTeller:
    """Tells what an agent knows of the target; ``vedette.net.witness.Teller``."""

    agent: Agent
    case: SearchCase
    known: None = None

    @property
    def _mission(self) -> Searching:
        return cast(Searching, self.agent.mission)

    def path(self, now: float) -> NDArray[np.float64]:
        """Return where the vehicle will fly, as far as it is planned."""
        agent, flight = self.agent, cast(FlightBehaviour, self.agent.behaviour).flight
        if agent.pose is None:
            return np.empty((0, 2))
        pose = np.array((agent.pose.x, agent.pose.y, agent.pose.heading))
        return ahead(flight, pose, self.case, agent.robot, step_of(now, self.case.pdf.dt))

    def content(self, now: float) -> bytes:
        """Return its pdf of the present step."""
        mission = self._mission
        pdf = mission.pdf(max(step_of(now, self.case.pdf.dt), mission.first_step))
        found, goal = mission.declared, mission.strategy.goal
        return _encode(
            PdfContent(
                pdf.step,
                zlib.compress(pdf.mass.astype("<f4").tobytes(), 1),
                None if found is None else DeclaredPlace(found.x, found.y, found.time, found.certain),
                None if goal is None else (float(goal[0]), float(goal[1])),
                tuple(
                    StepLooks(step, tuple((x, y, heading) for x, y, heading in poses.tolist()))
                    for step, poses in mission.looked
                ),
                pdf.outside,
                *pdf.frame.shape,
                pdf.frame.resolution,
                pdf.frame.origin_x,
                pdf.frame.origin_y,
            )
        )


def view_of(
    condition: Condition, payload: bytes, prior: TargetPdf
) -> tuple[SearchView, dict[int, NDArray[np.float64]]]:
    """Return what a vehicle reports, and from where it looked, (L, 3) by step.

    Raises:
        ValueError: malformed, or of another area.
    """
    told = read_content(payload)
    frame = frame_of(told)
    if frame != prior.frame:
        raise ValueError(f"report of a pdf over {frame}, not over {prior.frame}")
    at = condition.x, condition.y, condition.heading
    view = SearchView(
        SearchSample(*at, condition.state, True, path_of(condition), told.goal),
        replace(prior, mass=mass_of(told), step=told.step, outside=told.outside),
        None if told.declared is None else Declared(*told.declared),
        figures_of(condition),
    )
    return view, {each.step: np.array(each.poses, np.float64).reshape(-1, 3) for each in told.looks}


def read_content(payload: bytes) -> PdfContent:
    """Return a vehicle's belief; its grid is still packed.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_CONTENTS, payload, "report")


def frame_of(told: PdfContent) -> GridFrame:
    """Return where the cells lie that were told of."""
    return GridFrame(told.resolution, told.rows, told.cols, told.x, told.y)


def mass_of(told: PdfContent) -> NDArray[np.float64]:
    """Return ``(R, C)`` probability that the target is in each cell.

    Raises:
        ValueError: no pdf of that size.
    """
    mass = np.frombuffer(inflated(told.mass, 4 * told.rows * told.cols), "<f4").astype(np.float64)
    if not (np.isfinite(mass).all() and (mass >= 0.0).all() and mass.sum() + told.outside > 0.0):
        raise ValueError("report of a pdf that is none")
    return mass.reshape(told.rows, told.cols)
