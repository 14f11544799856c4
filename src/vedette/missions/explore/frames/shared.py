"""What one robot makes of how the team's frames lie: its own solution, and the plane that a round is on."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from vedette.agent.messages import FrameTold
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.kernels.tiles import SIDE, Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.frames.charts import Charts
from vedette.missions.explore.frames.graph import CLOSED, Placed, solved, told_by_both, within
from vedette.missions.explore.frames.layout import Box, around, laid_out
from vedette.missions.explore.frames.rendezvous import Guess, guessed

BORNE_OUT = 8.0, 0.15  # walls in common at least [m], and contradicted at most, that an edge may count
ALLOWED = 5.0, 0.25  # where more contradicts, and a larger share, two are not joined [m, 1]
AGAIN = 8  # versions of both, after which it is looked at anew whether they agree

REFUTED = 2.0, 0.5  # walls in common at most [m], or contradicted at least: two do not lie so
PATIENCE = 24  # versions of whoever tells of such an edge, in which it could have taken it back


class PairVerdict(NamedTuple):
    """What the evidence of two says of where one lies on the other."""

    versions: int  # of both
    bears_out: bool
    allows: bool = True
    refutes: bool = False
    same: int = 0  # walls in common [cm]


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
    _verdicts: dict[tuple[Key, Key, Transform], PairVerdict] = field(default_factory=dict)
    _refuted: dict[tuple[Key, FrameEdge], int] = field(default_factory=dict)  # by whom, since which version

    def __post_init__(self) -> None:
        self.charts = Charts(self.evidence, self.frame)
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
        self._find_false(told, middles)
        matches = {
            self._weighed(edge)
            for edges in told.values()
            for edge in edges
            if edge.kind is EdgeKind.MATCH and edge.a in middles and edge.b in middles
        }
        edges = [*matches, *told_by_both(told, middles)]
        self.graph = solved(edges, keys, middles, self._bears_out, self._allows)
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
        most = self.frame.resolution * min(self.frame.shape) / 2.0
        laid = laid_out(self.graph, self._boxes(self.known), self.gap, most)
        return tuple(FrameTold(*each.key, each.part, *each.there) for each in laid)

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

    def guesses(self) -> list[Guess]:
        """Return where components of the latest round's plane may lie on each other, as anybody guesses."""
        boxes, ground = self._boxes(self.plane), dict[Key, Box]()
        for part in set(self.parts.values()):
            members = {key: self.plane[key] for key in boxes if self.parts[key] == part}
            if members:
                ground |= dict.fromkeys(members, around(members, boxes))
        edges = [edge for edge in self.evidence.edges if edge.kind is EdgeKind.GUESS]
        return guessed(edges, self.plane, ground)

    def _agrees(self, parts: dict[Key, int]) -> bool:
        """Tell whether the root's components are this robot's, and lie within a tolerance as it has them."""
        boxes = self._boxes(self.known)
        if parts.keys() != boxes.keys():
            return False
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

    def _bears_out(self, a: Key, b: Key, there: Transform) -> bool:
        return self._verdict(a, b, there).bears_out

    def _allows(self, a: Key, b: Key, there: Transform) -> bool:
        return self._verdict(a, b, there).allows

    def _weighed(self, edge: FrameEdge) -> FrameEdge:
        """Return a match that weighs no more than the evidence of both says, whatever is told of it."""
        a, b, there = edge[:3] if edge.a < edge.b else edge.inverse[:3]
        return edge._replace(weight=min(edge.weight, self._verdict(a, b, there).same))

    def _find_false(self, told: Mapping[Key, Sequence[FrameEdge]], seen: Collection[Key]) -> None:
        """Note who goes on telling of matches that the evidence of both refutes.

        An honest robot takes such an edge back as soon as it knows of that evidence.
        """
        refuted: dict[tuple[Key, FrameEdge], int] = {}
        for key, edges in told.items():
            for edge in edges:
                if edge.kind is not EdgeKind.MATCH or edge.a not in seen or edge.b not in seen:
                    continue
                a, b, there = edge[:3] if edge.a < edge.b else edge.inverse[:3]
                if self._verdict(a, b, there).refutes:
                    version = self.evidence.copies[key].version
                    refuted[key, edge] = self._refuted.get((key, edge), version)
        self._refuted = refuted
        late = {
            key[0]
            for (key, _), since in refuted.items()
            if key != self.key and self.evidence.copies[key].version >= since + PATIENCE
        }
        self.evidence.misleading = frozenset(late)

    def _verdict(self, a: Key, b: Key, there: Transform) -> PairVerdict:
        """Return what the evidence of two says of where one lies on the other, looked at now and then."""
        copies = self.evidence.copies
        versions = copies[a].version + copies[b].version
        known = self._verdicts.get((a, b, there))
        if known is not None and versions < known.versions + AGAIN:
            return known
        found = self.charts.agreement(a, b, there)
        if found is None:
            verdict = PairVerdict(versions, False)
        else:
            shift, turn = self.charts.pulled(a, b, there)
            straight = shift <= CLOSED[0] and turn <= CLOSED[1]
            verdict = PairVerdict(
                versions,
                straight and found.same >= BORNE_OUT[0] and found.contradicted <= BORNE_OUT[1],
                found.against < ALLOWED[0] or found.contradicted <= ALLOWED[1],
                found.same < REFUTED[0] or found.contradicted > REFUTED[1],
                round(100.0 * found.same),
            )
        self._verdicts[a, b, there] = verdict
        return verdict


def _middle(box: Box) -> tuple[float, float]:
    return (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0
