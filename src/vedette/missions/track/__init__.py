"""Tracking targets."""
