"""An exploring team that is to be started as processes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.config import OF_BODY
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
    shared_clock = False  # robots begin when they have found each other

    @property
    def lattice(self) -> Lattice:
        """That the robots agree on."""
        return self.options.lattice_on(self.world.frame)

    @property
    def size(self) -> int:
        """Number of robots."""
        return len(self.specs)

    def write(self, folder: Path) -> None:
        """Write the world that the robots are simulated in."""
        self.world.save(folder)

    def config(self, i: int, pose: Sequence[float] | None) -> dict[str, Any]:
        """Return what a robot's file says of its mission; ``pose``: where it is put, None: at its start."""
        spec = self.specs[i]
        x, y, heading = self.starts[i].tolist() if pose is None else pose
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
                **{name: getattr(spec, name) for name in OF_BODY},
            },
        }
