"""What goes wrong in a simulation, and when: schedules from files or seeds, and their play over time."""

from vedette.sim.faults.clock import SkewedClock
from vedette.sim.faults.files import faults_text, load_faults, save_faults
from vedette.sim.faults.kinds import Fault, Schedule
from vedette.sim.faults.rules import check_faults
from vedette.sim.faults.seeds import faults_from_seed
from vedette.sim.faults.staged import StagedLinks
from vedette.sim.faults.timeline import Crashes, Freezes, Happening, Restarts, Skews, Thaws, Timeline

__all__ = [
    "Crashes",
    "Fault",
    "Freezes",
    "Happening",
    "Restarts",
    "Schedule",
    "SkewedClock",
    "Skews",
    "StagedLinks",
    "Thaws",
    "Timeline",
    "check_faults",
    "faults_from_seed",
    "faults_text",
    "load_faults",
    "save_faults",
]
