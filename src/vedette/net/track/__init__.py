"""A tracking team as processes: what its vehicles are told and tell, and how the operator sees them."""
