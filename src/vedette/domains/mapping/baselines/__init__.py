"""Published planners to compare with: how each chooses, all else being that of ``MappingPlatform``."""
