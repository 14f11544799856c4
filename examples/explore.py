"""Two robots explore a flat of three rooms; then the same mission once more, step by step."""

import numpy as np

from vedette import run
from vedette.agent.events import Scan

solid = np.zeros((60, 100), bool)  # 10 x 6 m in cells of 0.1 m; row 0 is the lowest y
solid[:, [0, -1]] = solid[[0, -1], :] = True  # the outer walls
solid[:24, 35] = solid[36:, 35] = True  # two walls between the rooms, each with a door of 1.2 m
solid[:24, 70] = solid[36:, 70] = True
world = (solid, 0.1)

# To the end in one call: every figure of summary.json is an attribute, and the map is an array.
result = run.explore(world, team=2, seed=1, progress=lambda now: print(f"{now.t:5.1f} s {now.coverage:.2f}"))
print(f"{result.outcome}: {result.coverage:.3f} known after {result.time_s} s, 90 % after {result.t90_s} s")
print("cells unknown, free, occupied:", np.bincount(result.map.ravel(), minlength=3))
result.save("runs/flat")  # what the command writes: map, pictures, summary.json

# Two seconds at a time: where each robot is, what it has just seen, what it wants, what is undecided.
mission = run.Explore(world, team=2, seed=1)
while mission.step(ticks=20) is None:
    print(f"{mission.now:.0f} s, cells known: {np.count_nonzero(mission.map)}")
    robots = zip(mission.poses, mission.states, mission.observed, mission.deciding, strict=True)
    for (x, y, _), state, observed, deciding in robots:
        nearest = [f"{event.ranges.min():.2f}" for event in observed if isinstance(event, Scan)]
        wants = deciding.strategy.views.round(1).tolist()
        print(f"  {state} at {x:.1f}, {y:.1f}; nearest wall {nearest} m; tour {wants}, {deciding.pending=}")
assert mission.result().to_json() == result.to_json()  # looking at it has changed nothing
