"""Protocols of the network: a spanning tree over whatever links exist, and its edges made reliable."""

from vedette.overlay.overlay import Overlay
from vedette.overlay.reliable import ReliableLink
from vedette.overlay.stamp import Stamp
from vedette.overlay.status import LinkStatus, Place, Status

__all__ = ["LinkStatus", "Overlay", "Place", "ReliableLink", "Stamp", "Status"]
