"""What is written of merged maps."""
