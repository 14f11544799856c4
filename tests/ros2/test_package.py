"""The ROS package: its launch file with a double of launch, its view, its own arguments, colcon's build."""

from __future__ import annotations

import importlib.util
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

from tests.support.places import ROOT
from vedette.net.config import AgentConfig
from vedette.scenario import as_scenario

PACKAGE = ROOT / "ros2" / "vedette_ros"
HOW_TO = ROOT / "docs" / "how-to" / "ros2.md"


class Made:
    """Remembers how something of launch was made."""

    def __init__(self, *given: Any, **named: Any) -> None:
        self.given, self.named = given, named


def test_the_launch_file_starts_one_agent_with_the_robots_file(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, parts in {
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument"],
        "launch.substitutions": ["LaunchConfiguration"],
        "launch_ros": [],
        "launch_ros.actions": ["Node"],
    }.items():
        double = ModuleType(name)
        for part in parts:
            setattr(double, part, type(part, (Made,), {}))
        monkeypatch.setitem(sys.modules, name, double)
    told = runpy.run_path(str(PACKAGE / "launch" / "agent.launch.py"))["generate_launch_description"]()
    *arguments, node = told.given[0]
    assert [argument.given for argument in arguments] == [("config",), ("namespace",), ("wait",)]
    assert [argument.named.get("default_value") for argument in arguments] == [None, "", "60"]
    assert node.named["namespace"].given == ("namespace",)
    assert (node.named["package"], node.named["executable"]) == ("vedette_ros", "agent")
    config, option, wait = node.named["arguments"]
    assert (config.given, option, wait.given) == (("config",), "--wait", ("wait",))


@pytest.mark.parametrize(
    ("given", "own"),
    [
        (["robot.yaml"], ["robot.yaml"]),
        (["robot.yaml", "--speed", "2", "--ros-args", "-r", "__node:=a"], ["robot.yaml", "--speed", "2"]),
        (["robot.yaml", "--ros-args", "-r", "__ns:=/a"], ["robot.yaml", "--namespace", "/a"]),
    ],
)
def test_the_agent_leaves_out_what_ros_adds(given: list[str], own: list[str]) -> None:
    assert runpy.run_path(str(PACKAGE / "vedette_ros" / "agent.py"))["own"](given) == own


def test_what_the_package_installs_is_there_and_its_names_agree() -> None:
    setup = (PACKAGE / "setup.py").read_text()
    installed = re.findall(r"\"((?:launch|rviz)/[^\"]+|package\.xml)\"", setup)
    assert {path.partition("/")[0] for path in installed} == {"launch", "rviz", "package.xml"}
    for path in installed:
        assert (PACKAGE / path).is_file(), path
    assert ElementTree.parse(PACKAGE / "package.xml").findtext("name") == "vedette_ros"
    assert (PACKAGE / "resource" / "vedette_ros").is_file()


def test_the_view_shows_only_what_agents_publish() -> None:
    view = yaml.safe_load((PACKAGE / "rviz" / "vedette.rviz").read_text())["Visualization Manager"]
    topics = {each["Topic"]["Value"] for each in view["Displays"] if "Topic" in each}
    documented = set(re.findall(r"`(vedette/\w+)` \| `\w+_msgs/", HOW_TO.read_text()))
    assert {topic.removeprefix("/robot1/") for topic in topics} == documented


def test_the_robots_file_of_the_how_to_can_be_read() -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", HOW_TO.read_text(), re.DOTALL)
    config = as_scenario(yaml.safe_load(text), AgentConfig, "the how-to's file")
    assert config.body.ros2 is not None
    assert config.body.ros2.namespace == "robot1"


@pytest.mark.skipif(importlib.util.find_spec("colcon_ros") is None, reason="`make test-ros2` has colcon")
def test_colcon_builds_the_package_and_what_it_installs_runs(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "src" / "vedette_ros")
    command = [str(Path(sys.executable).parent / "colcon"), "build"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert built.returncode == 0, built.stderr
    installed = tmp_path / "install" / "vedette_ros"
    (found,) = installed.glob("lib/python*/site-packages")
    agent = [sys.executable, str(found / "vedette_ros" / "agent.py"), "--help"]
    said = subprocess.run(agent, capture_output=True, text=True, timeout=60, check=True).stdout
    assert "CONFIG.yaml" in said
    assert (installed / "share" / "vedette_ros" / "launch" / "agent.launch.py").is_file()
