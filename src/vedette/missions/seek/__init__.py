"""Looking for somebody in a building that nobody knows: mapping and searching at once."""
