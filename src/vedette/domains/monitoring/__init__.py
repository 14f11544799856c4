"""Monitoring: a team keeps a scalar field known that changes while it is measured. docs/monitoring.md"""
