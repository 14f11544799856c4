"""Two vehicles follow three targets for 40 s, step by step; then the ways of coordination compared."""

import numpy as np

from vedette import run

seeing = {"type": "range-bearing", "range": 160, "view": 180, "range_noise": 6, "bearing_noise": 3}
scenario = {
    "area": [0, 0, 400, 300],  # [m]
    "duration": 40,  # [s]
    "decisions": 2,
    "vehicles": [
        {"name": "hawk", "start": [60, 60, 45], "sensor": seeing},
        {"name": "kite", "start": [340, 60, 135], "sensor": seeing},
    ],
    "targets": [
        {"name": "car", "model": "constant-velocity", "mean": [120, 200, 3, 0], "sd": [30, 30, 1, 1]},
        {"name": "van", "model": "constant-velocity", "mean": [300, 220, -2, -1], "sd": [30, 30, 1, 1]},
        {"name": "mast", "model": "static", "mean": [200, 120], "sd": [40, 40]},
    ],
}

mission = run.Track(scenario, seed=3)
while mission.step(ticks=100) is None:  # of 0.1 s
    deviations = np.sqrt(np.trace(mission.covariances[:, :2, :2], axis1=1, axis2=2))
    print(f"{mission.now:.0f} s, place known to {deviations.round(1)} m; turn rates decided on [rad/s]:")
    for name, deciding in zip(mission.scene.vehicles, mission.deciding, strict=True):
        print(f"  {name}: {np.round(deciding.strategy.rates, 2)} from step {deciding.strategy.k0} on")
alone = mission.result()

result = run.track(scenario, seed=3)  # as `vedette track` does: compared with the other ways afterwards
assert result.entropy_mean_nat == alone.entropy_mean_nat
for name, quality in result.comparison.items():
    print(f"{name:10} entropy {quality.entropy_mean_nat:5.1f} nat, error {quality.position_rmse_m:4.1f} m")
