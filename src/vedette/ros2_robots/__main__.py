"""``python -m vedette.ros2_robots ROBOTS.yaml``: let robots live until they are told to stop."""

from __future__ import annotations

import argparse
import os
import signal
import threading
import time
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from vedette.ros2_robots.robots import Strangers


def main() -> None:
    """Run the robots of a file."""
    options = argparse.ArgumentParser(prog="python -m vedette.ros2_robots", description=__doc__)
    options.add_argument("robots", type=Path, metavar="ROBOTS.yaml")
    options.add_argument("--speed", type=float, default=1.0, help="seconds of the simulation in a second")
    options.add_argument("--sim-time", action="store_true", help="stamp by the simulation, and tell /clock")
    options.add_argument("--starter", type=int, help="stop when this process, the parent, ends")
    asked = options.parse_args()
    context = rclpy.Context()
    rclpy.init(args=[], context=context, signal_handler_options=SignalHandlerOptions.NO)
    simulation = Strangers(asked.robots, context, asked.speed, asked.sim_time)
    executor = SingleThreadedExecutor(context=context)
    for node in simulation.nodes:
        executor.add_node(node)
    stopped = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stopped.set())
    if asked.starter is not None:
        threading.Thread(target=_outlive, args=(asked.starter, stopped), daemon=True).start()
    print("robots: ready", flush=True)
    while not stopped.is_set():
        executor.spin_once(timeout_sec=0.5)
    for robot, touched in zip(simulation.robots, simulation.collided, strict=True):
        print(f"{robot.spec['namespace']}: {robot.navigator.ended}, collided: {touched}", flush=True)


def _outlive(starter: int, stopped: threading.Event) -> None:
    while os.getppid() == starter:
        time.sleep(1.0)
    stopped.set()


if __name__ == "__main__":
    main()
