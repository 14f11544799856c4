"""Where the target is taken to be at first, by what the scenario says: parts, less what is known of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.belief import normalised
from vedette.domains.search.clues import SearchedTrack, missed_by, rings, without
from vedette.domains.search.priors import GaussianPart, gaussians, heat_map, mixture, polygon, uniform
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.missions.search.scenario import Gaussian, Heat, Polygon, Prior, Rings, SearchScenario, Uniform


def parts_of(scenario: SearchScenario, folder: Path) -> list[NDArray[np.float64]]:
    """Return each part of the prior by itself, ``(R, C)`` of sum 1; its files lie in the folder.

    Raises:
        InputError: a part that is none; the line names its field.
    """
    return [_part(i, part, scenario.frame, folder) for i, part in enumerate(scenario.prior)]


def prior_of(scenario: SearchScenario, parts: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """``P(x) ~ sum_j w_j P_j(x) m(x)``, m what tracks searched already missed, 0 in no-go areas; (V55).

    Raises:
        InputError: a track or an area that is none, or nothing is left.
    """
    frame = scenario.frame
    tracks = [SearchedTrack(np.array(each.path), each.width, each.detection) for each in scenario.searched]
    mass = mixture(frame, [(part.weight, mass) for part, mass in zip(scenario.prior, parts, strict=True)])
    mass = mass * missed_by(frame, tracks) * without(frame, scenario.no_go)
    return normalised(frame, mass, "prior, less what is searched and no_go,")


def _part(i: int, part: Prior, frame: GridFrame, folder: Path) -> NDArray[np.float64]:
    try:
        match part:
            case Uniform():
                return uniform(frame)
            case Polygon():
                return polygon(frame, part.corners)
            case Heat():
                return heat_map(frame, folder / part.file, part.extent)
            case Rings():
                return rings(frame, part.centre, part.distances, part.within)
            case Gaussian():
                if part.sigma is not None and part.covariance is not None:
                    raise InputError("give either sigma or covariance")
                spread = part.sigma if part.sigma is not None else part.covariance
                if spread is None:
                    raise InputError("give sigma or covariance")
                return gaussians(frame, [GaussianPart(part.mean, spread)])
    except InputError as error:
        said = str(error).removeprefix("prior: ").removeprefix("gaussian 1: ")
        raise InputError(f"prior[{i}]: {said}") from error
