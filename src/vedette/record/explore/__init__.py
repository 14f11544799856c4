"""What an exploration leaves: what was measured, log, summary, MCAP record, pictures, film, live view."""
