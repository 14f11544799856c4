"""The ament_python package: a launch file and a view for RViz; the agent itself is the package vedette."""

from setuptools import setup

NAME = "vedette_ros"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/agent.launch.py"]),
        (f"share/{NAME}/rviz", ["rviz/vedette.rviz"]),
    ],
    install_requires=["setuptools"],
    entry_points={"console_scripts": ["agent = vedette_ros.agent:main"]},
    license="Apache-2.0",
    description="Starts a Vedette agent beside a robot's Nav2.",
)
