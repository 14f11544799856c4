"""The figures by which planners are compared."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.study.rows import Row


@dataclass(frozen=True)
class Metric:
    """A column of the results, and when it means something."""

    column: str
    title: str
    unit: str
    bound: str = ""  # column of what no team can go below
    whole: bool = False  # only of missions that are complete: one that gives up early is not fast
    scale: float = 1.0  # from the column's unit to this one

    @property
    def label(self) -> str:
        """Title and unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    def of(self, row: Row) -> float | None:
        """Return the figure of a run; ``None`` where there is none: a level not reached, a run that broke."""
        return None if self.whole and not row["completed"] else self._number(row.get(self.column))

    def bound_of(self, row: Row) -> float | None:
        """Return what the figure cannot be below in this run, whatever the planner."""
        return self._number(row.get(self.bound)) if self.bound else None

    def _number(self, value: object) -> float | None:
        return self.scale * float(value) if isinstance(value, int | float) else None


TIMES = (
    Metric("t50_s", "T50", "s", "bound_t50_s"),
    Metric("t90_s", "T90", "s", "bound_t90_s"),
    Metric("t95_s", "T95", "s", "bound_t95_s"),
    Metric("t99_s", "T99", "s", "bound_t99_s"),
    Metric("time_s", "total", "s", "bound_s", whole=True),
    Metric("auc_s", "AUC", "s", "bound_auc_s", whole=True),
)
TOTAL, AUC = TIMES[4], TIMES[5]
COSTS = (
    Metric("path_m", "path a robot", "m", whole=True),
    Metric("path_max_m", "longest path", "m", whole=True),
    Metric("overlap", "overlap", "%", whole=True, scale=100.0),
    Metric("seen_std_m2", "deviation of areas seen", "m²", whole=True),
)
QUALITY = (
    Metric("coverage", "coverage", "%", scale=100.0),
    Metric("map_error_share", "map errors", "%", scale=100.0),
    Metric("collisions", "collisions", ""),
)
COMPARED = (*TIMES, *COSTS)
PLANNING = (
    Metric("planning_p50_ms", "a replan, median", "ms"),
    Metric("planning_p95_ms", "95th percentile", "ms"),
    Metric("planning_max_ms", "longest", "ms"),
    Metric("real_time_factor", "simulated s a second", ""),
    Metric("wall_s", "a mission", "s"),
)


def traffic(rows: list[Row]) -> tuple[Metric, ...]:
    """Return a metric for each kind of bytes that these runs sent."""
    kinds = [name.removeprefix("bytes_") for row in rows[:1] for name in row if name.startswith("bytes_")]
    return tuple(Metric(f"bytes_{kind}", kind, "kB", whole=True, scale=1e-3) for kind in kinds)
