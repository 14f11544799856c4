"""Monitoring, simulated: the true field and those who measure it."""
