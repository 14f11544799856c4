"""Search: vehicles look for a lost target, whose probability is a grid (paper, section 6)."""
