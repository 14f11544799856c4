"""What a tracking mission leaves: its log, summary, MCAP record, pictures, film and live view."""
