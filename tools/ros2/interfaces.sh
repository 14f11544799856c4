#!/usr/bin/env bash
# Build the ROS 2 interfaces that are on no package index into an environment that has rclpy from wheels.
#   tools/ros2/interfaces.sh DISTRIBUTION ENVIRONMENT BUILD
set -euo pipefail
distribution=$1
environment=$(cd "$2" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$3"
build=$(cd "$3" && pwd)
rm -rf "$build/interfaces"
cp -r "$here/interfaces" "$build"
if [ "$distribution" = jazzy ]; then # whose result has a code, but no message
	sed -i '/^string error_msg$/d' "$build/interfaces/nav2_msgs/action/NavigateToPose.action"
fi
export PATH="$environment/bin:$PATH" LD_LIBRARY_PATH="$environment/lib" AMENT_PREFIX_PATH="$environment"
for package in tf2_msgs map_msgs nav2_msgs; do
	into="$build/$package"
	rm -rf "$into"
	mkdir "$into"
	# The wheels name a folder of the host they were built on: generating says so and fails, making does not.
	cmake -S "$build/interfaces/$package" -B "$into" -DCMAKE_INSTALL_PREFIX="$environment" \
		-DCMAKE_PREFIX_PATH="$environment" -DBUILD_TESTING=OFF -DPython3_EXECUTABLE="$environment/bin/python" \
		>"$into.log" 2>&1 || true
	make -C "$into" -j2 install >>"$into.log" 2>&1 || {
		tail -n 20 "$into.log" >&2
		exit 1
	}
done
