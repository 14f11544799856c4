"""Grid maps in the team frame, and their files."""

from vedette.maps.frame import FREE, OCCUPIED, UNKNOWN, GridFrame

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "GridFrame"]
