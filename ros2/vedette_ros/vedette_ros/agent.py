"""``ros2 run vedette_ros agent CONFIG.yaml``: as ``vedette agent``, without what ROS adds to commands."""

from __future__ import annotations

import sys

from vedette.cli import main as vedette


def own(arguments: list[str]) -> list[str]:
    """Return the arguments before ``--ros-args``, and of what comes after it the namespace."""
    end = arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)
    told = [each.removeprefix("__ns:=") for each in arguments[end:] if each.startswith("__ns:=")]
    return [*arguments[:end], *(["--namespace", told[-1]] if told else [])]


def main() -> None:
    """Run the agent."""
    sys.argv = ["vedette", "agent", *own(sys.argv[1:])]
    vedette()


if __name__ == "__main__":
    main()
