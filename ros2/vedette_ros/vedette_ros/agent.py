"""``ros2 run vedette_ros agent CONFIG.yaml``: as ``vedette agent``, without what ROS adds to commands."""

from __future__ import annotations

import sys

from vedette.cli import main as vedette


def own(arguments: list[str]) -> list[str]:
    """Return the arguments before ``--ros-args``, which names and remaps nodes that are none of ours."""
    end = arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)
    return arguments[:end]


def main() -> None:
    """Run the agent."""
    sys.argv = ["vedette", "agent", *own(sys.argv[1:])]
    vedette()


if __name__ == "__main__":
    main()
