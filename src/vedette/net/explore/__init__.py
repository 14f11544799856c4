"""An exploring team as processes: what its robots are told and tell, and how the operator sees them."""
