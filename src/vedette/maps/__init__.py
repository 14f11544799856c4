"""Grid maps in the team frame, and their files."""

from vedette.maps.frame import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.map_server import map_files, read_map, write_map

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "GridFrame", "map_files", "read_map", "write_map"]
