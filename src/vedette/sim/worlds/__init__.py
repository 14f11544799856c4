"""Generated worlds: offices, caves and mazes, each different and each fit for a team of robots."""
