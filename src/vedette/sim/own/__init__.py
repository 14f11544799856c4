"""Missions of own domains, simulated."""
