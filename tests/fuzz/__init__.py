"""Fuzzing of what a robot reads from others or from files: ``python -m tests.fuzz --seconds 60 [TARGET...]``.

A target takes bytes and breaks if what reads them raises anything but ValueError, takes too long or too much
memory, or refuses its input and has changed nevertheless. Inputs that once broke something lie in ``corpus``.
"""
