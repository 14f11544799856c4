#!/usr/bin/env bash
# Make an environment of `make test-ros2` beside the developers' one, whose packages it sees, if it is not ready.
#   tools/ros2/environment.sh DISTRIBUTION ENVIRONMENT DEVELOPERS BUILD     DISTRIBUTION: kilted or jazzy
# Exit status 3, with a line that says so: there are no wheels of rclpy for this platform.
set -euo pipefail
distribution=$1 environment=$2 developers=$3 build=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ -e "$environment/.ready" ] && [ -z "$(find "$here" -newer "$environment/.ready")" ]; then
	exit 0
fi
version=$("$developers/bin/python" -c 'import sys; print(f"{sys.version_info[0]}.{sys.version_info[1]}")')
case "$(uname -sm) $version" in
"Linux x86_64 3.11" | "Linux x86_64 3.12" | "Linux x86_64 3.13") ;;
*)
	echo "skipped: there are no wheels of rclpy for $(uname -sm) with Python $version" >&2
	exit 3
	;;
esac
echo "making $environment: rclpy of ${distribution^} and simulated robots; once, a minute or two"
"$developers/bin/python" -m venv --clear "$environment"
site=$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
developed=$("$developers/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
echo "import site; site.addsitedir('$developed')" >"$site/_developers.pth"
"$environment/bin/python" -m pip install --disable-pip-version-check --quiet \
	-c "$here/../../constraints.txt" -r "$here/$distribution.txt"
"$here/interfaces.sh" "$distribution" "$environment" "$build"
touch "$environment/.ready"
