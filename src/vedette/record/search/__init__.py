"""What a search leaves: its log, summary, MCAP record, pictures, film and live view."""
