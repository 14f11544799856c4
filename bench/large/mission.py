"""One mission of the bench of large teams, measured: a script that needs nothing but a Vedette's Python.

``mission.py WIDTH HEIGHT RESOLUTION ROBOTS MAX_TIME FOLDER`` explores an office and writes one line of JSON.
It imports nothing of the bench, so that the Python of an older Vedette can run it too.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from pathlib import Path

import numpy as np

from vedette import run
from vedette.sim.worlds import office


def main(width: float, height: float, resolution: float, robots: int, max_time: float, folder: Path) -> None:
    """Explore an office; CPU time counts from where the team is put into it until its record is closed."""
    world, explore = office(np.random.default_rng(0), width, height, resolution), run.Explore
    began = time.process_time()
    mission = explore(world, robots, max_time=max_time, record=folder)
    while mission.step(10) is None:
        pass
    result = mission.result()
    cpu = time.process_time() - began
    sent = [sum(vars(traffic).values()) for traffic in result.bytes.values()]
    planning = result.timing.planning_ms
    told = {
        "outcome": result.outcome.value,
        "coverage": result.coverage,
        "time_s": result.time_s,
        "cpu_s": cpu,
        "planning_p50_ms": None if planning is None else planning.p50,
        "planning_p95_ms": None if planning is None else planning.p95,
        "peak_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "record_bytes": (folder / "run.mcap").stat().st_size,
        "sent_bytes": sum(sent) / robots,
    }
    print(json.dumps(told))


if __name__ == "__main__":
    _width, _height, _cell, _robots, _most, _folder = sys.argv[1:]
    main(float(_width), float(_height), float(_cell), int(_robots), float(_most), Path(_folder))
