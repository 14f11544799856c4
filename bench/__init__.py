"""Benchmarks (``python -m bench``) and the table of missions (``python -m bench.missions``)."""

from pathlib import Path

RESULTS = Path(__file__).parent / "results"  # where both write, unless told otherwise
