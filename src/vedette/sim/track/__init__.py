"""Tracking, simulated: targets, scenarios, the joint optimum to compare with, the run."""
