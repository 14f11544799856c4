"""Starts a Vedette agent beside a robot's Nav2."""
