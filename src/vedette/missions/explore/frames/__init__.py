"""Exploring in a team that shares no frame: how robots' frames are found, agreed on and used."""
