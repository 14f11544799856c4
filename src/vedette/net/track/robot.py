"""A tracking vehicle, from its file."""

from __future__ import annotations

from pathlib import Path

from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.scenario import default_scenario, read_scenario
from vedette.net.config import AgentConfig
from vedette.net.flights import check_number, judge_of, round_times
from vedette.net.notary import notary_of
from vedette.net.robot import Robot
from vedette.net.simulated import simulated_tracker
from vedette.net.track.content import TrackTeller


def tracker(config: AgentConfig, folder: Path, boot: int, speed: float) -> Robot:
    """Return the vehicle; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: the scenario cannot be used, or has no such vehicle.
    """
    assert config.track is not None
    scenario = default_scenario() if config.scenario is None else read_scenario(folder / config.scenario)
    check_number(config.robot, len(scenario.vehicles))
    team = TrackTeam(scenario, config.track, round_times(config.links, speed))
    notary, terms = notary_of(config, folder, team.terms, speed)
    agent = team.assemble(config.robot - 1, boot, notary)
    judge = judge_of(config, team, agent, notary)
    body, teller = simulated_tracker(config, team), TrackTeller(agent, scenario)
    return Robot(agent, body, None, teller, terms, judge=judge)
