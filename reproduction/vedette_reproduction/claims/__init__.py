"""What the paper claims, each tried by a computation of its own."""
