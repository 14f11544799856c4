"""Recorded data of real robots: lidar scans with the poses from which they were taken."""

from vedette.logs.carmen import read_carmen
from vedette.logs.recorded import RecordedLog, RecordedScan

__all__ = ["RecordedLog", "RecordedScan", "read_carmen"]
