"""Searching, simulated: the hidden target, scenarios, trials, curves, the run."""
