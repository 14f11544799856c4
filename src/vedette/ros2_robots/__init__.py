"""Simulated robots that run ROS 2, to try a team against where there is none: strangers to Vedette.

Bodies and lidars are those of ir-sim, ways those of scikit-image; their navigator answers as Nav2's does.
Nothing here is Vedette's, and nothing of Vedette is here: ``python -m vedette.ros2_robots ROBOTS.yaml``.
"""
