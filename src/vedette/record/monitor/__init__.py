"""What monitoring leaves: its log, figures, record, pictures and live view."""
