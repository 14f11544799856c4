"""A real robot's body: what it tells over ROS 2, and driving it by Nav2's NavigateToPose.

All is plain functions and state machines on arrays and times, except ``node``, which alone imports rclpy.
"""
