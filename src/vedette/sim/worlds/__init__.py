"""Generated worlds: offices, caves and mazes, each seed another, each fit for a team of robots."""

from vedette.sim.worlds.cave import cave
from vedette.sim.worlds.maze import maze
from vedette.sim.worlds.office import office

GENERATORS = {"office": office, "cave": cave, "maze": maze}

__all__ = ["GENERATORS", "cave", "maze", "office"]
