"""What stands between an agent and its robot."""

TICK = 0.1  # of poses, at most; simulated bodies move in such steps [s]
