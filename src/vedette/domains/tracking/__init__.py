"""Tracking: Gaussian targets that a team of turning or moving sensors observes (paper, section 3.3)."""
