import numpy as np
from numpy.typing import NDArray

# lidar
def cast_rays(
    solid: NDArray[np.uint8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    max_range: float,
    discs: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def integrate_scan(
    log_odds: NDArray[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> NDArray[np.int64]: ...
def count_sightings(
    log_odds: NDArray[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    max_range: float,
    bin_m: float,
    stride: int,
    nudge: float,
) -> NDArray[np.int64]: ...

# frontier
def traversable(classes: NDArray[np.uint8], radius_m: float, resolution: float) -> NDArray[np.uint8]: ...
def find_frontiers(
    classes: NDArray[np.uint8], min_cells: int, max_extent_cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]: ...

# distance
def distance_field(
    traversable: NDArray[np.uint8], source: int, resolution: float, stop_at: NDArray[np.int64] | None
) -> NDArray[np.float32]: ...
def distance_matrix(
    traversable: NDArray[np.uint8], cells: NDArray[np.int64], resolution: float, limit_m: float
) -> NDArray[np.float32]: ...
def path_to(field: NDArray[np.float32], traversable: NDArray[np.uint8], target: int) -> NDArray[np.int64]: ...
def shortcut(traversable: NDArray[np.uint8], path: NDArray[np.int64]) -> NDArray[np.int64]: ...

# visibility
def visible_cells(
    solid: NDArray[np.uint8], poses: NDArray[np.uint8], range_cells: float
) -> NDArray[np.uint8]: ...
def line_of_sight(
    blocked: NDArray[np.uint8], from_cell: int, to_cells: NDArray[np.int64]
) -> NDArray[np.bool_]: ...

# motion
def clearance(
    solid: NDArray[np.bool_], resolution: float, x: float, y: float, reach: float
) -> float: ...
def steer(
    solid: NDArray[np.bool_],
    traversable: NDArray[np.bool_],
    resolution: float,
    pose: tuple[float, float, float],
    path: NDArray[np.float64],
    arc: NDArray[np.float64],
    progress: tuple[float, float],
    others: NDArray[np.float64],
    limits: tuple[float, float, float, float],
) -> tuple[float, float, float, float, float]: ...
