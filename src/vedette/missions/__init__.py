"""Missions: a domain and a way of fusing, put together for the agent."""
