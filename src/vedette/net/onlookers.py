"""Who makes pictures of a team on the network: by its mission, from one of its robots' files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vedette.missions.search.case import default_case, read_case
from vedette.missions.track.scenario import default_scenario, read_scenario
from vedette.net.config import AgentConfig
from vedette.net.domain_picture import DomainOnlooker
from vedette.net.explore.picture import ExploreOnlooker
from vedette.net.feed import Onlooker
from vedette.net.search.picture import SearchOnlooker
from vedette.net.simulated import domain_of
from vedette.net.track.picture import TrackOnlooker


def onlooker_of(config: AgentConfig, folder: Path, only: int | None = None) -> Onlooker[Any, Any]:
    """Return who looks at a robot's team; ``folder``: what paths in its file are relative to.

    ``only``: at one vehicle alone, by its index.

    Raises:
        InputError: its scenario cannot be used.
    """
    scenario = None if config.scenario is None else folder / config.scenario
    if config.domain is not None:
        domain = domain_of(config.domain.name)
        return DomainOnlooker(domain, domain.case(scenario), only)
    if config.search is not None:
        return SearchOnlooker(default_case() if scenario is None else read_case(scenario), only)
    if config.track is not None:
        if scenario is None:
            return TrackOnlooker(default_scenario(), config.mission, only)
        return TrackOnlooker(read_scenario(scenario), scenario.stem, only)
    return ExploreOnlooker(config.team)
