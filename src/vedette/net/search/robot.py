"""A searching vehicle, from its file."""

from __future__ import annotations

from pathlib import Path

from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.case import default_case, read_case
from vedette.net.config import AgentConfig
from vedette.net.flights import check_number, judge_of, round_times
from vedette.net.notary import notary_of
from vedette.net.robot import Robot
from vedette.net.search.content import SearchTeller
from vedette.net.simulated import simulated_searcher


def searcher(config: AgentConfig, folder: Path, boot: int, speed: float) -> Robot:
    """Return the vehicle; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: the scenario cannot be used, or has no such vehicle.
    """
    assert config.search is not None
    case = default_case() if config.scenario is None else read_case(folder / config.scenario)
    check_number(config.robot, len(case.names))
    team = SearchTeam(case, config.search, round_times(config.links, speed))
    notary, terms = notary_of(config, folder, team.terms, speed)
    agent = team.assemble(config.robot - 1, boot, notary)
    judge = judge_of(config, team, agent, notary)
    body, teller = simulated_searcher(config, case), SearchTeller(agent, case)
    return Robot(agent, body, None, teller, terms, judge=judge)
