"""A domain of somebody's own, of vehicles that look at something that stays as it is: all but its theory."""
