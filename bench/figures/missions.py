"""Which missions the documents quote, and what is kept of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Mission:
    """A mission by its command, with the figures and pictures that the documents show of it."""

    command: str
    figures: tuple[str, ...]  # fields of its summary.json, inner ones after a dot, and FREE_AREA
    pictures: Mapping[str, str] = field(default_factory=dict)  # in docs/images: file that the mission leaves
    before: str = ""  # the command that makes its world
    map: str = ""  # name of its map in the folder of maps


FREE_AREA = "free_m2"  # on the map that the mission leaves
EXPLORED = ("outcome", "coverage", "t90_s", "t99_s", "time_s", "collisions")
WAYS = ("none", "shared", "negotiated", "optimum")  # of coordination
TRACKED = ("entropy_mean_nat", "position_rmse_m", "nees", "in_view")
TRACK_SEEDS = range(4)

MISSIONS: Mapping[str, Mission] = {
    "office": Mission("vedette explore", EXPLORED, {"office.png": "progress.png"}),
    "willow": Mission(
        "vedette explore willow-full.yaml --robots 4",
        (*EXPLORED, FREE_AREA),
        {"willow.png": "progress.png"},
        map="willow-full",
    ),
    "framed": Mission(
        "vedette explore --frames unknown",
        (*EXPLORED, "frames.error_m"),
        {"framed.png": "progress.png"},
    ),
    "storm": Mission(
        "vedette explore my-world/map.yaml --robots 3 --radio 6 --faults 4",
        EXPLORED,
        before="vedette world maze --seed 1 --width 10 --height 10 --out my-world",
    ),
    **{
        f"track-{seed}": Mission(
            f"vedette track --seed {seed}" if seed else "vedette track",
            tuple(f"comparison.{way}.{name}" for way in WAYS for name in TRACKED),
            {} if seed else {"track.png": "tracks.png", "track-entropy.png": "entropy.png"},
        )
        for seed in TRACK_SEEDS
    },
    "search": Mission(
        "vedette search",
        ("outcome", "found_s", "detection", "mean_time_s"),
        {"search.png": "pdf.png", "search-detection.png": "detection.png"},
    ),
}
