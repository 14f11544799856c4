"""``python -m bench.stonesoup``: Stone Soup's sensor managers beside ours."""

try:
    import stonesoup as _  # noqa: F401
except ImportError:
    raise SystemExit("bench.stonesoup needs Stone Soup; run: pip install 'vedette[stonesoup]'") from None
