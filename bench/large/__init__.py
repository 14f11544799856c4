"""Large worlds, fine cells and large teams, before and after a change."""
