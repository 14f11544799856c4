"""How a mission ends."""

from __future__ import annotations

from enum import StrEnum

NO_PROGRESS = 300.0  # a team without a new route for so long has come to its end [s]


class Outcome(StrEnum):
    """Why a mission ended."""

    COMPLETE = "complete"  # all agents agree that nothing reachable is worth seeing
    TIME_LIMIT = "time_limit"  # --max-time passed
    INTERRUPTED = "interrupted"  # Ctrl-C
    TEAM_LOST = "team_lost"  # no robot is alive
    NO_PROGRESS = "no_progress"  # living robots, work left, and no new route for anybody for too long
