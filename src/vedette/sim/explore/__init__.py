"""Exploring in simulation."""
