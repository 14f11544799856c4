"""Why a navigator gave a goal up: Humble's result is empty, Iron's has a code, Kilted's a message too."""

from __future__ import annotations

from typing import Any

CODES = {  # of NavigateToPose; of the planner and of the controller, which it hands on
    9001: "its behaviour tree did not load",
    9002: "it lacks a transform",
    9003: "it took too long",
    202: "its planner lacks a transform",
    203: "the robot is outside of its map",
    204: "the place is outside of its map",
    205: "the robot stands in what its costmap has as occupied",
    206: "the place is occupied in its costmap",
    207: "its planner took too long",
    208: "its planner finds no way",
    102: "its controller lacks a transform",
    104: "its controller ran out of patience",
    105: "the robot made no progress",
    106: "its controller finds no safe motion",
    107: "its controller took too long",
}


def reason_of(result: Any) -> str:
    """Return what a ``NavigateToPose.Result`` says; '': nothing."""
    code, message = int(getattr(result, "error_code", 0)), str(getattr(result, "error_msg", ""))
    known = CODES.get(code, "")
    return ", ".join(
        said for said in (known, f"code {code}" if code else "", " ".join(message.split())) if said
    )
