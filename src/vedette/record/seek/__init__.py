"""What is told of a search in an unknown building."""
