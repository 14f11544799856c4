#!/usr/bin/env bash
# Run tests with real rclpy, apart from all other ROS on this host and network.
#   tools/ros2/test.sh ENVIRONMENT [PYTEST ARGUMENT]...
# JAZZY: another environment, for teams of both; without it tests of them are skipped.
set -euo pipefail
environment=$(cd "$1" && pwd)
shift
export PATH="$environment/bin:$PATH" LD_LIBRARY_PATH="$environment/lib" AMENT_PREFIX_PATH="$environment"
export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST MPLBACKEND=Agg
exec "$environment/bin/python" -m pytest -p no:randomly tests/ros2 "$@"
