"""Recorded data through the agents of a team, fused and planned on as if it were seen now."""
