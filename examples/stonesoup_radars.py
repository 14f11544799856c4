"""Stone Soup's rotating radars negotiate who watches which target, for eight seconds.

Only the manager is ours: sensors, targets, predictor, updater and the loop are Stone Soup's.
"""

from datetime import datetime, timedelta

import numpy as np
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.sensor.radar import RadarRotatingBearingRange
from stonesoup.types.array import StateVector
from stonesoup.types.groundtruth import GroundTruthState
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.types.track import Track
from stonesoup.updater.kalman import ExtendedKalmanUpdater

from vedette.stonesoup import VedetteSensorManager

rng, now, second = np.random.default_rng(4), datetime(2026, 1, 1), timedelta(seconds=1)
model = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.05), ConstantVelocity(0.05)])
predictor, updater = KalmanPredictor(model), ExtendedKalmanUpdater(measurement_model=None)

radars = [
    RadarRotatingBearingRange(
        position=StateVector(place), position_mapping=(0, 2), ndim_state=4,
        noise_covar=np.diag([np.radians(1.0) ** 2, 5.0**2]), dwell_centre=StateVector([0.0]),
        rpm=29, resolution=np.radians(30), fov_angle=np.radians(30), seed=int(place[0]),
    )
    for place in ([0.0, 0.0], [100.0, 0.0], [50.0, 100.0])
]  # fmt: skip
for radar in radars:
    radar.timestamp = now

targets = [StateVector(rng.uniform(0, 100, 4) * [1.0, 0.02, 1.0, 0.02]) for _ in range(8)]  # x, vx, y, vy
guesses = [target + rng.normal(0.0, 3.0, (4, 1)) for target in targets]
tracks = [Track([GaussianState(guess, np.diag([9.0] * 4), timestamp=now)]) for guess in guesses]

manager = VedetteSensorManager(set(radars), predictor=predictor)  # in place of GreedySensorManager(...)
for _ in range(8):
    now += second
    for radar, actions in manager.choose_actions(tracks, now)[0].items():
        radar.add_actions(actions)
        radar.act(now)
    targets = [model.matrix(time_interval=second) @ target for target in targets]
    for target, track in zip(targets, tracks, strict=True):
        track.append(predictor.predict(track, timestamp=now))
        for radar in radars:
            for detection in radar.measure({GroundTruthState(target, timestamp=now)}):
                track[-1] = updater.update(SingleHypothesis(track.state, detection))
    looks, done = [round(float(np.degrees(radar.dwell_centre[0, 0]))) for radar in radars], manager.last
    print(f"{now:%S} s: looks at {looks} deg, {done.reward:.2f} nats; none gives over {done.bound:.2f}")

errors = [float(np.hypot(*(track.mean - x)[[0, 2], 0])) for track, x in zip(tracks, targets, strict=True)]
print(f"{done.messages} messages a second; targets known to {np.mean(errors):.1f} m on average")
