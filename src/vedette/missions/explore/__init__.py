"""Exploring a building."""
