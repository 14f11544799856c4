"""Monitoring a field."""
