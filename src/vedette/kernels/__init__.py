"""The typed doors to the compiled kernels, a topic each, beside the twins that specify them."""
