"""What an agent beside a ROS 2 robot costs, and how soon it drives again: ``python -m bench.ros2``.

It wants a Python with rclpy and the simulated robots, as `make test-ros2` makes one, and the variables that
``tools/ros2/test.sh`` sets.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread
from typing import Any

import numpy as np

from vedette.agent import Agent
from vedette.agent.events import Pose
from vedette.kernels.lidar import cast_rays
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.options import ExploreOptions
from vedette.net.explore.ros2_plan import Ros2Plan, environment, strangers
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.launch import TeamProcesses
from vedette.net.team import TeamWatch
from vedette.net.transport import Operator
from vedette.record.summary import Setting
from vedette.ros2.body import Ros2Body
from vedette.ros2.node import RosDoor
from vedette.ros2.recorded import SCANS, TRANSFORMS, RecordedDoor
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.showing import Showing
from vedette.sim.starts import choose_starts
from vedette.sim.worlds import office
from vedette.team import Most, PlatformSpec

TICKS = os.sysconf("SC_CLK_TCK")
PAGE = os.sysconf("SC_PAGE_SIZE")
DOMAIN = 60  # of ROS, for this bench
LIMIT = 30.0  # for a robot that is to drive again [s]


def plan(robots: int) -> Ros2Plan:
    """Return robots in the default office, at real time."""
    world: World = office(np.random.default_rng([0, 0]), 30.0, 20.0)
    specs = [PlatformSpec(name=f"robot-{i + 1}") for i in range(robots)]
    starts = choose_starts(world, specs, np.random.default_rng([0, 1]))
    return Ros2Plan(world, specs, starts, ExploreOptions(), 0, 1.0, 3.0)


@dataclass
class Usage:
    """CPU time and memory of one process, looked at once a second while it lasts."""

    pid: int
    looks: list[tuple[float, float, float]] = field(default_factory=list)  # when, CPU time [s], memory [MB]
    _over: Event = field(default_factory=Event)

    def __enter__(self) -> Usage:
        """Begin to look."""
        self._thread = Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Look no more."""
        self._over.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._over.wait(1.0):
            try:
                self.look()
            except OSError:
                return

    def look(self) -> float:
        """Look once; return its CPU time until now [s]."""
        told = Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
        cpu, memory = (int(told[11]) + int(told[12])) / TICKS, int(told[21]) * PAGE / 1e6
        self.looks.append((time.monotonic(), cpu, memory))
        return cpu

    @property
    def core(self) -> float:
        """Share of a core that it took."""
        (then, before, _), (now, after, _) = self.looks[0], self.looks[-1]
        return (after - before) / max(now - then, 1e-9)

    @property
    def memory(self) -> float:
        """At most [MB]."""
        return max(memory for *_, memory in self.looks)


class Goals:
    """Hears which goals a robot's navigator is given."""

    def __init__(self) -> None:
        """Listen to the first robot."""
        import rclpy
        from action_msgs.msg import GoalStatusArray
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.qos import qos_profile_action_status_default

        self._context, self.seen = rclpy.Context(), set[bytes]()
        rclpy.init(args=[], context=self._context, domain_id=DOMAIN)
        self._node = rclpy.create_node("bench", context=self._context)
        self._node.create_subscription(
            GoalStatusArray,
            "/robot1/navigate_to_pose/_action/status",
            self._hear,
            qos_profile_action_status_default,
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def _hear(self, message: Any) -> None:
        self.seen |= {bytes(told.goal_info.goal_id.uuid) for told in message.status_list}

    def wait(self, span: float, *, for_new: bool = False) -> float:
        """Listen for so long, or until there is a new goal; return for how long that was [s]."""
        began, before = time.monotonic(), set(self.seen)
        while time.monotonic() < began + span and not (for_new and self.seen - before):
            self._executor.spin_once(timeout_sec=0.05)
        return time.monotonic() - began


def _same(message: Any) -> Any:
    return message


def of_parts(scans: int = 300) -> Iterator[tuple[str, float]]:
    """Yield what one robot's scans cost on their way into the map, and what is shown of the map."""
    from geometry_msgs.msg import TransformStamped
    from sensor_msgs.msg import LaserScan
    from tf2_msgs.msg import TFMessage

    team = plan(1)
    spec, options, world = team.specs[0], ExploreOptions(), team.world
    agent = assemble(options.lattice(0.1), spec, options, 0, 1, robots=1, most=Most.of([spec]))
    settings = Ros2Settings(namespace="bench", no_return="free")
    recorded = RecordedDoor(settings)
    body = Ros2Body(spec, settings, recorded)
    free = np.argwhere(~world.solid)
    path = free[np.linspace(0, len(free) - 1, scans).astype(int)]
    angles = np.linspace(-np.pi, np.pi, spec.beams, endpoint=False)
    spent, pose = [], Pose(0.0, 0.0, 0.0)
    for k, (row, col) in enumerate(path.tolist()):
        x, y = (col + 0.5) * world.frame.resolution, (row + 0.5) * world.frame.resolution
        ranges = cast_rays(world.solid, world.frame.resolution, x, y, angles, spec.range, np.empty((0, 3)))
        ranges = np.where(ranges < spec.range, ranges, np.inf).astype(np.float32).tolist()
        scan = LaserScan(angle_min=-np.pi, angle_increment=2 * np.pi / spec.beams, range_max=spec.range)
        scan.header.frame_id, scan.ranges = "base_link", ranges
        scan.time_increment = 0.1 / spec.beams
        scan.header.stamp.sec = k
        frames = TFMessage()
        for parent, child in (("map", "odom"), ("odom", "base_link")):
            for later in (0, 1):
                joint = TransformStamped()
                joint.header.frame_id, joint.child_frame_id, joint.header.stamp.sec = parent, child, k + later
                if child == "base_link":
                    joint.transform.translation.x, joint.transform.translation.y = x, y
                frames.transforms.append(joint)
        began = time.thread_time()
        recorded.hear("/bench/tf", TRANSFORMS, partial(_same, frames))
        recorded.hear("/bench/scan", SCANS, partial(_same, scan))
        for event in body.sense(float(k)):
            if isinstance(event, Pose):
                pose = event
            else:
                agent.mission.observe(event, pose, [], float(k))
        spent.append(1e3 * (time.thread_time() - began))
    agent.mission.publish(0.0)
    yield "scan to evidence, CPU [ms], middle", float(np.median(spent))
    yield "the same, 95 of 100", float(np.percentile(spent, 95))
    yield from _of_showing(agent, body, settings)


def _of_showing(agent: Agent, body: Ros2Body, settings: Ros2Settings) -> Iterator[tuple[str, float]]:
    """Yield what showing the map once a second costs, changed each time, by a real node."""
    body.door = RosDoor(settings, "bench")
    show, spent = Showing(agent, body, "robot-1"), []
    for k in range(30):
        agent.rounds.decisions += 1
        began = time.process_time()
        show(float(k))
        spent.append(time.process_time() - began)
    body.door.close()
    yield "topics, share of a core at 1 Hz", float(np.mean(spent))


def measured(robots: int, span: float) -> Iterator[tuple[str, float]]:
    """Yield figures of a team that explores for a while; then the first agent is killed and started again."""
    team, around = plan(robots), environment(DOMAIN)
    with TemporaryDirectory() as folder, ExitStack() as stack:
        private, logs = Path(folder) / "private", Path(folder) / "logs"
        private.mkdir()
        team.write(private)
        stack.enter_context(strangers(private, logs / "robots.log", team.speed, around))
        processes = stack.enter_context(TeamProcesses(team, private, logs, None, around))
        operator = stack.enter_context(Operator(processes.operator))
        usages = [Usage(process.pid) for process in processes.processes]
        watch = TeamWatch(team, processes, operator, ExploreWatcher(team, Setting(seed=0)), span)
        with ExitStack() as looking:
            for usage in usages:
                looking.enter_context(usage)
            report = watch.run()
        yield "agents' share of a core, rounds included, at most", max(usage.core for usage in usages)
        rounds = report.summary.rounds
        planning = report.timing.planning_ms
        if planning is not None:
            yield "a round's planning [ms], middle", planning.p50
            yield "of that share, planning", rounds * planning.p50 / 1e3 / max(report.summary.time_s, 1.0)
        yield "agents' memory [MB], at most", max(usage.memory for usage in usages)
        yield "mission time per second", report.timing.real_time_factor
        goals = Goals()
        goals.wait(2.0)
        processes.signal(0, signal.SIGKILL)
        processes.processes[0].wait()
        goals.wait(1.0)
        processes.restart(0)
        yield "from the start of a killed agent to its next goal [s]", goals.wait(LIMIT, for_new=True)
        yield "its CPU time until then [s]", Usage(processes.processes[0].pid).look()
        yield "running processes that wait for a core", os.getloadavg()[0]


def main() -> None:
    """Print the figures as lines of JSON."""
    options = argparse.ArgumentParser(prog="python -m bench.ros2", description=__doc__)
    options.add_argument("--robots", type=int, default=3)
    options.add_argument("--span", type=float, default=90.0, help="of the mission [s]")
    asked = options.parse_args()
    os.environ.update(environment(DOMAIN))
    for name, value in chain(of_parts(), measured(asked.robots, asked.span)):
        print(json.dumps({name: round(value, 4)}), flush=True)


if __name__ == "__main__":
    main()
