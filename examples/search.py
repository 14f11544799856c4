"""Two vehicles look for somebody adrift; their pdf of where he is, step by step."""

import numpy as np

from vedette import run

scenario = {
    "area": [0, 0, 1200, 800],  # [m]
    "cell": 40,
    "duration": 120,  # [s]
    "step": 2,
    "horizon": 12,
    "replan": 2,
    "decisions": 3,
    "prior": [
        {"type": "gaussian", "mean": [500, 500], "sigma": 120, "weight": 2},
        {"type": "gaussian", "mean": [900, 300], "sigma": 100, "weight": 1},
    ],
    "target": {"drift": [0.5, 0.2], "diffusion": 4},
    "detector": {"type": "exponential", "detection": 0.8, "sigma": 60, "power": 2, "range": 120, "noise": 15},
    "vehicles": [
        {"name": "petrel", "start": [100, 100, 40], "speed": 30, "turn_rate": 0.25},
        {"name": "tern", "start": [160, 100, 40], "speed": 25, "turn_rate": 0.3},
    ],
}

mission = run.Search(scenario, seed=5, record="runs/adrift")  # run.mcap grows there
while mission.step(ticks=100) is None:  # of 0.1 s
    row, col = np.unravel_index(mission.pdf.argmax(), mission.pdf.shape)
    x, y = mission.scene.frame.centres(np.array([row * mission.pdf.shape[1] + col]))[0]
    print(f"{mission.now:.0f} s, most likely near {x:.0f}, {y:.0f} m ({mission.pdf.max():.3f})")
result = mission.result()
print(f"{result.outcome} after {result.time_s:.0f} s, {result.error_m:.0f} m off; by {result.found_by}")
print(f"detected by then with probability {result.detection_then:.2f}")
result.save("runs/adrift")
