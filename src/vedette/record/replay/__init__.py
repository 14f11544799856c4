"""What is kept of replayed logs."""
