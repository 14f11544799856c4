import numpy as np
from numpy.typing import NDArray

_Tiles = tuple[NDArray[np.int32], NDArray[np.int8], tuple[int, int]]
_Worth = tuple[NDArray[np.float32], tuple[int, int], tuple[int, int], tuple[float, float, float, float]]
_Stops = tuple[
    NDArray[np.int64],
    tuple[NDArray[np.uint32], NDArray[np.uint32]],
    NDArray[np.uint8],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.float64],
]
_TourProblem = tuple[
    _Worth,
    NDArray[np.float64],
    tuple[NDArray[np.uint32], NDArray[np.uint8]],
    _Stops,
    tuple[float, float],
]

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
    grid: _Tiles,
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
) -> tuple[bool, NDArray[np.int64]]: ...
def integrate_blurred_scan(
    grid: _Tiles,
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    margins: NDArray[np.float64],
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> tuple[bool, NDArray[np.int64]]: ...
def count_sightings(
    grid: _Tiles,
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    max_range: float,
    bin_m: float,
    berths: int,
    step: int,
    stride: int,
    nudge: float,
) -> NDArray[np.int64]: ...

# frontier
def traversable(classes: NDArray[np.uint8], radius_m: float, resolution: float) -> NDArray[np.uint8]: ...
def find_frontiers(
    classes: NDArray[np.uint8], min_cells: int, max_extent_cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]: ...

# distance
def distance_field(traversable: NDArray[np.uint8], source: int, resolution: float) -> NDArray[np.float32]: ...
def lengths_to(
    traversable: NDArray[np.uint8], source: int, targets: NDArray[np.int64], resolution: float
) -> NDArray[np.float32]: ...
def shortest_path(
    traversable: NDArray[np.uint8], source: int, target: int, resolution: float
) -> NDArray[np.int64]: ...
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
def clearance(solid: NDArray[np.bool_], resolution: float, x: float, y: float, reach: float) -> float: ...
def block_discs(free: NDArray[np.bool_], resolution: float, discs: NDArray[np.float64]) -> None: ...
def steer(
    solid: NDArray[np.bool_],
    traversable: NDArray[np.bool_],
    first: tuple[int, int],
    resolution: float,
    pose: tuple[float, float, float],
    path: NDArray[np.float64],
    arc: NDArray[np.float64],
    progress: tuple[float, float, float],
    others: NDArray[np.float64],
    limits: tuple[float, float, float, float, float],
) -> tuple[float, float, float, float, float]: ...
def remaining(path: NDArray[np.float64], here: tuple[float, float], length: float) -> NDArray[np.float64]: ...

# coverage
LAYERS: int

def viewpoints(
    field: NDArray[np.float32],
    source: int,
    resolution: float,
    classes: NDArray[np.uint8],
    cells: NDArray[np.int64],
    starts: NDArray[np.int64],
    reach: int,
    most: int,
    work: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], float, bool]: ...
def berths(classes: NDArray[np.uint8], step: int, most: int) -> NDArray[np.uint8]: ...
def footprints(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    views: NDArray[np.int64],
    facing: NDArray[np.float64],
    range_cells: float,
    view: float,
    table: NDArray[np.float32],
    by_distance: bool,
    rays: int,
    factor: int,
    floor: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]: ...
def components(cells: NDArray[np.bool_]) -> NDArray[np.int64]: ...
def combine(
    keys_a: NDArray[np.uint32],
    misses_a: NDArray[np.uint8],
    keys_b: NDArray[np.uint32],
    misses_b: NDArray[np.uint8],
    layers: int,
) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]: ...
def pack_misses(keys: NDArray[np.uint32], misses: NDArray[np.uint8], cells: int, layers: int) -> bytes: ...
def unpack_misses(
    data: bytes, cells: int, layers: int, most: int
) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]: ...
def marginals(
    worth: _Worth,
    layer_weights: NDArray[np.float64],
    others_keys: NDArray[np.uint32],
    others_misses: NDArray[np.uint8],
    starts: NDArray[np.int64],
    keys: NDArray[np.uint32],
    misses: NDArray[np.uint8],
) -> NDArray[np.float64]: ...
def number_cells(cells: NDArray[np.uint32]) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]: ...
def best_tour(
    problem: _TourProblem, current: NDArray[np.int64], max_stops: int, turning: tuple[float, float]
) -> tuple[NDArray[np.int64], float, float]: ...
def most_any_tour_adds(problem: _TourProblem, max_stops: int) -> float: ...

# tracking
def track_values(
    tracks: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    measure: str,
    others: tuple[NDArray[np.int64], NDArray[np.float64]],
    starts: NDArray[np.int64],
    own: tuple[NDArray[np.int64], NDArray[np.float64]],
) -> NDArray[np.float64]: ...
def track_gradient(
    tracks: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    measure: str,
    team: tuple[NDArray[np.int64], NDArray[np.float64]],
) -> NDArray[np.float64]: ...
def track_lines(
    sight: tuple[float, float, float, float, float],
    offsets: NDArray[np.float64],
    covariances: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def track_foreseen(
    sight: tuple[float, float, float, float, float],
    view: tuple[float, float],
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
    covariances: NDArray[np.float64],
) -> NDArray[np.float64]: ...

# search
def propagate(
    mass: NDArray[np.float64],
    first: tuple[int, int],
    row_taps: NDArray[np.float64],
    col_taps: NDArray[np.float64],
    leaves: bool,
) -> NDArray[np.float64]: ...
def look_footprints(
    shape: tuple[int, int],
    resolution: float,
    poses: NDArray[np.float64],
    table: NDArray[np.float64],
    range: float,
    view: float,
    samples: int,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64]]: ...
def detected_mass(
    mass: NDArray[np.float64],
    first: tuple[int, int],
    row_taps: NDArray[np.float64],
    col_taps: NDArray[np.float64],
    leaves: bool,
    steps: int,
    layers: int,
    keys: NDArray[np.uint32],
    misses: NDArray[np.uint8],
) -> NDArray[np.float64]: ...
def path_gains(
    mass: NDArray[np.float64],
    first: tuple[int, int],
    row_taps: NDArray[np.float64],
    col_taps: NDArray[np.float64],
    leaves: bool,
    steps: int,
    weights: NDArray[np.float64],
    others_keys: NDArray[np.uint32],
    others_misses: NDArray[np.uint8],
    parents: NDArray[np.int64],
    starts: NDArray[np.int64],
    cells: NDArray[np.uint32],
    misses: NDArray[np.uint8],
) -> NDArray[np.float64]: ...

# align
def align_peaks(
    a: tuple[NDArray[np.float32], ...],
    b: tuple[NDArray[np.float64], ...],
    angles: NDArray[np.float64],
    weights: tuple[float, ...],
    wanted: tuple[int, int],
) -> NDArray[np.float64]: ...
def align_counts(
    grid: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    faces: tuple[NDArray[np.float64], NDArray[np.uint8]],
    transforms: NDArray[np.float64],
) -> NDArray[np.int64]: ...
def align_fit(
    grid: tuple[NDArray[np.int32], float, tuple[float, ...]],
    on: tuple[NDArray[np.float64], ...],
    moving: tuple[NDArray[np.float64], ...],
    guess: tuple[float, float, float],
    reaches: NDArray[np.float64],
) -> NDArray[np.float64]: ...

# render
def render_tiles(
    source: tuple[NDArray[np.int64], NDArray[np.uint8]],
    wanted: NDArray[np.int64],
    ground: tuple[int, int, int, int, int],
    motion: tuple[int, int, int, int],
) -> NDArray[np.uint8]: ...

# field
def field_factor(
    band: NDArray[np.float64],
    starts: NDArray[np.int64],
    columns: NDArray[np.int64],
    weights: NDArray[np.float64],
    information: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]: ...
def field_covariance(
    factor: NDArray[np.float64],
    starts: NDArray[np.int64],
    columns: NDArray[np.int64],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def field_gains(
    covariance: NDArray[np.float64],
    starts: NDArray[np.int64],
    places: NDArray[np.int64],
    roots: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def field_variances(factor: NDArray[np.float64]) -> NDArray[np.float64]: ...
