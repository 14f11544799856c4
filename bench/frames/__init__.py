"""``python -m bench.frames``: how often two maps of unknown frames are joined, rightly and wrongly."""
