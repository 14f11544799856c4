"""The kernels' twins in plain NumPy, a module a topic: their specification, and the oracle of their tests."""
