"""Searching for a target."""
