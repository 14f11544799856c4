"""Worlds: generated offices, caves and mazes, each seed another, and real buildings that a lidar has seen."""

from vedette.sim.worlds.by_name import GENERATORS, WORLD, generated
from vedette.sim.worlds.cave import cave
from vedette.sim.worlds.logged import NO_RETURNS, logged
from vedette.sim.worlds.maze import maze
from vedette.sim.worlds.office import office

__all__ = ["GENERATORS", "NO_RETURNS", "WORLD", "cave", "generated", "logged", "maze", "office"]
