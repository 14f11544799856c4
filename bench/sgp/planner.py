"""Ways of a team by SGP-Tools: ``PYTHON planner.py TASK.json WAYS.json`` in the environment that has it.

Its own order of things: places spread over the area, a round trip each over them (OR-Tools), and then all
way points moved along the gradient of its sparse Gaussian process's bound, the ways held to the budget by a
penalty. Nothing of Vedette is imported; without arguments it says the version of SGP-Tools.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

WAY_POINTS = 20  # of a robot
SAMPLED = 4  # measurements that it counts with along each leg, its ends among them
SPACING = 2.0  # of the places whose field it wants to know [m]
PENALTY = 250.0  # a metre over the budget; of its own benchmarks
SECONDS = 10  # for the round trips


def plan(task: dict[str, Any]) -> list[list[list[float]]]:
    """Return a way a robot: places [m], the first is where it stands."""
    gpflow, methods = import_module("gpflow"), import_module("sgptools.methods")
    import_module("tensorflow").random.set_seed(task["seed"])
    np.random.seed(task["seed"])  # noqa: NPY002
    x0, y0, x1, y1 = task["area"]
    across, up = (np.arange(low + 0.5 * SPACING, high, SPACING) for low, high in ((x0, x1), (y0, y1)))
    wanted = np.column_stack([axis.ravel() for axis in np.meshgrid(across, up)])
    starts = np.array(task["starts"], np.float64)
    robots = len(starts)
    spread = import_module("sgptools.utils.misc").get_inducing_pts(
        wanted, WAY_POINTS * robots, seed=task["seed"]
    )
    trips, _ = import_module("sgptools.utils.tsp").run_tsp(
        spread,
        num_vehicles=robots,
        max_dist=task["budget"],
        resample=WAY_POINTS,
        start_nodes=starts,
        time_limit=SECONDS,
    )
    transform = import_module("sgptools.core.transformations").IPPTransform(
        sampling_rate=SAMPLED,
        distance_budget=task["budget"],
        num_robots=robots,
        Xu_fixed=starts[:, None],
        constraint_weight=PENALTY,
    )
    # Matern of 3/2, the next that it has to a smoothness of 1; at twice its length scale too, cells have 0.14
    kernel = gpflow.kernels.Matern32(variance=1.0, lengthscales=0.5 * task["length"])
    noise = (task["noise"] / task["deviation"]) ** 2
    method = methods.ContinuousSGP(
        WAY_POINTS, wanted, kernel, noise, transform, num_robots=robots, X_init=trips.reshape(-1, 2)
    )
    inside = np.clip(method.optimize(), wanted.min(axis=0), wanted.max(axis=0))
    ways: list[list[list[float]]] = inside.tolist()
    return ways


def main(arguments: list[str]) -> None:
    """Read the task, write the ways and what they took."""
    found = version("sgptools")
    if not arguments:
        sys.stdout.write(f"{found}\n")
        return
    task = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
    began = time.process_time()
    answer = {"version": found, "ways": plan(task), "cpu_s": time.process_time() - began}
    Path(arguments[1]).write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
