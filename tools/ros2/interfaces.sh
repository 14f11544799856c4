#!/usr/bin/env bash
# Build the ROS 2 interfaces that are on no package index into an environment that has rclpy from wheels.
#   tools/ros2/interfaces.sh ENVIRONMENT BUILD
set -euo pipefail
environment=$(cd "$1" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$2"
build=$(cd "$2" && pwd)
export PATH="$environment/bin:$PATH" LD_LIBRARY_PATH="$environment/lib" AMENT_PREFIX_PATH="$environment"
for package in tf2_msgs nav2_msgs; do
	into="$build/$package"
	rm -rf "$into"
	mkdir "$into"
	# The wheels name a folder of the host they were built on: generating says so and fails, making does not.
	cmake -S "$here/interfaces/$package" -B "$into" -DCMAKE_INSTALL_PREFIX="$environment" \
		-DCMAKE_PREFIX_PATH="$environment" -DBUILD_TESTING=OFF -DPython3_EXECUTABLE="$environment/bin/python" \
		>"$into.log" 2>&1 || true
	make -C "$into" -j2 install >>"$into.log" 2>&1 || {
		tail -n 20 "$into.log" >&2
		exit 1
	}
done
