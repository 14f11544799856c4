"""An exploring team that is to be started as processes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import Order
from vedette.align import FramePose
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.config import OF_BODY
from vedette.net.simulated import as_told, frames_of
from vedette.team import PlatformSpec


@dataclass(frozen=True, eq=False)
class ExplorePlan:
    """``vedette.net.launch.TeamPlan``."""

    world: World
    specs: Sequence[PlatformSpec]
    starts: NDArray[np.float64]  # (n, 3) x, y, heading [m, m, rad], team frame
    options: ExploreOptions
    seed: int
    speed: float  # times real time
    lease: float = 3.0  # [s]
    frames: list[FramePose] = field(default_factory=list)  # where each robot's lies in the world; none: there
    _drawn: list[int] = field(default_factory=list)  # robots that have got another frame since
    shared_clock = False  # robots begin when they have found each other

    def __post_init__(self) -> None:
        if self.options.frames == "unknown" and not self.frames:
            self.frames.extend(frames_of(self.size, self.seed))

    @property
    def lattice(self) -> Lattice:
        """That the robots agree on."""
        return self.options.lattice_on(self.world.frame)

    @property
    def size(self) -> int:
        """Number of robots."""
        return len(self.specs)

    def as_told(self, order: Order) -> Order:
        """Return an order with its place in the frame of a robot, if all have frames of their own."""
        return as_told(order, self.frames) if self.frames else order

    def write(self, folder: Path) -> None:
        """Write the world that the robots are simulated in."""
        self.world.save(folder)

    def config(self, i: int, pose: Sequence[float] | None) -> dict[str, Any]:
        """Return what a robot's file says of its mission.

        ``pose``: where it is put, as it told it last; None: at its start. It is in a new frame then, if it is
        in one of its own.
        """
        spec = self.specs[i]
        x, y, heading = self.starts[i].tolist() if pose is None else self._put(i, pose)
        return {
            "best": {
                "range": max(spec.range for spec in self.specs),
                "speed": max(spec.speed for spec in self.specs),
            },
            "explore": msgspec.to_builtins(self.options),
            "body": {
                "map": "map.yaml",
                "start": [x, y, float(np.degrees(heading))],
                "seed": self.seed,
                **self._frame(i),
                **{name: getattr(spec, name) for name in OF_BODY},
            },
        }

    def _put(self, i: int, pose: Sequence[float]) -> tuple[float, float, float]:
        """Return where a robot is put in the world that is started again where it told that it is."""
        x, y, heading = pose
        if not self.frames:
            return x, y, heading
        at = self.frames[i].after(FramePose(x, y, heading))
        self._drawn.append(i)
        self.frames[i] = frames_of(self.size + len(self._drawn), self.seed)[-1]
        return at.x, at.y, at.angle

    def _frame(self, i: int) -> dict[str, list[float]]:
        """Return what a robot's file says of its frame."""
        if not self.frames:
            return {}
        frame = self.frames[i]
        return {"frame": [frame.x, frame.y, float(np.degrees(frame.angle))]}
