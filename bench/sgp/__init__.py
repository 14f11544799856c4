"""SGP-Tools' planner beside ours: its environment is a separate one, and the two exchange files."""
