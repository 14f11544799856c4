"""What one robot makes of how the team's frames lie: its own solution, and the plane that a round is on."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

from vedette.agent.messages import FrameTold
from vedette.fusion.frame_edges import EdgeKind
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.kernels.tiles import SIDE, Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.frames.borne_out import BorneOut
from vedette.missions.explore.frames.charts import Charts
from vedette.missions.explore.frames.graph import Placed, solved, told_by_both, within
from vedette.missions.explore.frames.layout import Box, PlacedOnPlane, around, laid_out
from vedette.missions.explore.frames.rendezvous import Guess, guessed


@dataclass(eq=False)
class SharedFrames:
    """Solves the frames from what all have told, and lays them out."""

    evidence: FramedMap[Any]
    frame: GridFrame  # of everybody's cells
    gap: float  # between components on the plane, at least [m]
    charts: Charts = field(init=False)
    graph: dict[Key, Placed] = field(default_factory=dict)
    plane: dict[Key, Transform] = field(default_factory=dict)  # T_plane_contributor of the latest round
    parts: dict[Key, int] = field(default_factory=dict)  # the component of each, then
    _borne_out: BorneOut = field(init=False)

    def __post_init__(self) -> None:
        self.charts = Charts(self.evidence, self.frame)
        self._borne_out = BorneOut(self.evidence, self.charts)
        self.graph = {self.key: Placed(self.key, IDENTITY)}

    @property
    def key(self) -> Key:
        """This robot as a contributor."""
        return self.evidence.key

    @property
    def joined(self) -> Placed | None:
        """Where this robot's frame lies among those of whom it is joined with; None: it is with nobody."""
        own = self.graph[self.key]
        mates = any(key[0] != self.key[0] and own.anchor == each.anchor for key, each in self.graph.items())
        return own if mates else None

    @property
    def known(self) -> list[Key]:
        """Contributors who have seen anything, and this robot."""
        return sorted({self.key, *(key for key, copy in self.evidence.copies.items() if copy.version)})

    def solve(self) -> None:
        """Work out anew where contributors lie, and draw those that are joined in this robot's own frame."""
        keys = self.known
        middles = {key: _middle(box) for key, box in self._boxes(keys).items()}
        told = self.evidence.told
        self._borne_out.begin()
        self._borne_out.find_false(told, middles, self.key)
        edges = [*self._borne_out.matches(told, middles), *told_by_both(told, middles)]
        self.graph = solved(edges, keys, middles, self._borne_out.allows)
        anchor, own, _ = self.graph[self.key]
        back = own.inverse()
        self.evidence.place_own(
            {key: back.after(placed.there) for key, placed in self.graph.items() if placed.anchor == anchor}
        )

    def own(self, robot: int) -> Transform | None:
        """Return where the frame of a robot's latest start lies in this one's; None: it is not known."""
        return next(
            (there for key, there in sorted(self.evidence.frames.items(), reverse=True) if key[0] == robot),
            None,
        )

    def on_plane(self, robot: int) -> Transform | None:
        """Return where the frame of a robot's latest start lies on the plane; None: it is not on it."""
        return next((self.plane[key] for key in sorted(self.plane, reverse=True) if key[0] == robot), None)

    def lay_out(self) -> tuple[FrameTold, ...]:
        """As the root: return where contributors lie on the plane of a round that begins."""
        self.solve()
        return tuple(FrameTold(*each.key, each.part, *each.there) for each in self._laid_out())

    def _laid_out(self) -> list[PlacedOnPlane]:
        most = self.frame.resolution * min(self.frame.shape) / 2.0
        return laid_out(self.graph, self._boxes(self.known), self.gap, most)

    def take(self, told: Sequence[FrameTold]) -> bool:
        """Draw the plane as the root says; tell whether this robot has come to the same.

        Raises:
            ValueError: a contributor is told twice.
        """
        keys = [(each.robot, each.boot) for each in told]
        if len(set(keys)) < len(keys):
            raise ValueError("freeze: a contributor's frame is told twice")
        self.solve()
        self.plane = {
            key: Transform(each.x, each.y, each.angle) for key, each in zip(keys, told, strict=True)
        }
        self.evidence.place_plane(self.plane)
        self.parts = {key: each.part for key, each in zip(keys, told, strict=True)}
        return self._agrees(self.parts)

    def ground(self) -> Box | None:
        """Return what of the latest round's plane is this robot's component's: a gap ends halfway [m].

        None: the component is not on the plane.
        """
        box = self._grounds().get(self.parts.get(self.key, -1))
        if box is None:
            return None
        beside = self.gap / 2.0
        return box[0] - beside, box[1] - beside, box[2] + beside, box[3] + beside

    def _grounds(self) -> dict[int, Box]:
        """Return a box on the latest round's plane around what each component has seen [m]."""
        boxes, grounds = self._boxes(self.plane), dict[int, Box]()
        for part in set(self.parts.values()):
            members = {key: self.plane[key] for key in boxes if self.parts[key] == part}
            if members:
                grounds[part] = around(members, boxes)
        return grounds

    def guesses(self) -> list[Guess]:
        """Return where components of the latest round's plane may lie on each other, as anybody guesses."""
        grounds = self._grounds()
        ground = {key: grounds[part] for key, part in self.parts.items() if part in grounds}
        edges = [edge for edge in self.evidence.edges if edge.kind is EdgeKind.GUESS]
        return guessed(edges, self.plane, ground)

    def walls_apart(self) -> float | None:
        """Return how far walls that two joined maps have in common lie apart, at most [m]; None: none has."""
        frames = self.evidence.frames
        apart = (
            self._borne_out.walls_apart(a, b, frames[a].inverse().after(frames[b]))
            for a, b in combinations(sorted(frames), 2)
        )
        return max((shift for shift in apart if shift is not None), default=None)

    def _agrees(self, parts: dict[Key, int]) -> bool:
        """Tell whether the root's components are this robot's, and lie within a tolerance as it has them."""
        if parts.keys() != {each.key for each in self._laid_out()}:
            return False
        boxes = self._boxes(parts)
        first: dict[int, Key] = {}
        anchors = dict[int, Key]()
        for key in sorted(parts):
            part, placed = parts[key], self.graph[key]
            one = first.setdefault(part, key)
            if anchors.setdefault(part, placed.anchor) != placed.anchor:
                return False
            told = self.plane[one].inverse().after(self.plane[key])
            own = self.graph[one].there.inverse().after(placed.there)
            if not within(told, own, *_middle(boxes[key])):
                return False
        return len(set(anchors.values())) == len(anchors)

    def _boxes(self, keys: Collection[Key]) -> dict[Key, Box]:
        """Return a box around what each has seen, in its own frame [m]."""
        boxes: dict[Key, Box] = {}
        tiling, cell = Tiling(*self.frame.shape), self.frame.resolution
        for key in keys:
            copy = self.evidence.copies.get(key)
            if copy is not None and len(tiles := copy.known_tiles):
                rows, cols = tiling.corners(tiles)
                x0, y0 = self.frame.origin_x + cols.min() * cell, self.frame.origin_y + rows.min() * cell
                x1 = self.frame.origin_x + (cols.max() + SIDE) * cell
                y1 = self.frame.origin_y + (rows.max() + SIDE) * cell
                boxes[key] = float(x0), float(y0), float(x1), float(y1)
        return boxes


def _middle(box: Box) -> tuple[float, float]:
    return (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0
