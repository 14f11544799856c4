"""Mapping: an occupancy grid that a team of lidars completes (paper, sections 4 and 5)."""
