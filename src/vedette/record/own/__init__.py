"""What is told of a mission of an own domain."""
