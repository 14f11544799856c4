"""Studies: planners on many worlds, with statistics, pictures and a report that anybody can redo."""
