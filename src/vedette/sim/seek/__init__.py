"""Looking for somebody in an unknown building, in simulation."""
