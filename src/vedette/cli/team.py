"""``vedette team``: a team of agent processes on this host."""

from __future__ import annotations

from math import floor
from pathlib import Path
from typing import Any

import click
import numpy as np

from vedette.cli.domain import STATUS, domain_options, kind_of
from vedette.cli.exploring import EXPLORING, exploring_options, team_named, world_named
from vedette.cli.options import Output, output_options
from vedette.cli.searching import SEARCHING, searching_options
from vedette.cli.teams import Processes, process_options
from vedette.cli.tracking import TRACKING, tracking_options
from vedette.errors import InputError
from vedette.missions.explore.old_map import read_prior
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.pairs import scheme_of, tell_duration, tell_objective, tell_unheeded, tell_unsaid
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.missions.track.scenario import default_scenario
from vedette.net.config import DomainOptions
from vedette.net.domain import DomainWatcher
from vedette.net.domain_picture import DomainOnlooker
from vedette.net.explore.picture import ExploreOnlooker
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.ros2_plan import Ros2Plan
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.flights import FlightsPlan
from vedette.net.search.picture import SearchOnlooker
from vedette.net.search.watch import SearchWatcher
from vedette.net.track.picture import TrackOnlooker
from vedette.net.track.watch import TrackWatcher
from vedette.record.explore.log import ExploreScene
from vedette.record.search.curves import ideal
from vedette.record.search.log import SearchScene
from vedette.record.summary import Setting
from vedette.record.track.log import TrackScene
from vedette.run.inputs import files_of, orders_in, world_of
from vedette.run.searching import case_of, heat_maps
from vedette.run.tracking import scenario_of
from vedette.sim.domains import DOMAINS, DomainEntry, entry_of, own_domain
from vedette.sim.orders import check_frames, check_orders
from vedette.sim.search.hidden import Hidden
from vedette.sim.starts import choose_starts
from vedette.sim.track.targets import Targets


class _Missions(click.Group):
    """What a team of processes does; domains that are declared as one object are imported when asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all missions."""
        return sorted([*super().list_commands(ctx), *DOMAINS])

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a mission's command."""
        house = super().get_command(ctx, cmd_name)
        if house is not None or not (cmd_name in DOMAINS or own_domain(cmd_name)):
            return house
        return _domain_command(entry_of(cmd_name))


@click.group(cls=_Missions)
def team() -> None:
    """Start a team of agent processes on this host and watch it."""


@team.command()
@exploring_options
@process_options
@click.option(
    "--ros2", is_flag=True, help="Bodies are ROS 2 robots with a navigator like Nav2's, simulated by ir-sim."
)
@output_options
def explore(
    map_path: Path | None,
    resolution: float | None,
    robots: int | None,
    team: Path | None,
    starts: str | None,
    drift: float | None,
    seed: int,
    planner: str,
    scheme: str | None,
    fusion: str,
    max_time: float,
    return_home: bool,
    area: tuple[tuple[float, float], ...] | None,
    unbounded: bool,
    prior: Path | None,
    frames: str,
    rendezvous: bool,
    processes: Processes,
    ros2: bool,
    output: Output,
) -> None:
    """Let a team of agent processes explore MAP: one process a robot, linked by mutual TLS here.

    Keys are made for the occasion. MAP and the outputs are as for `vedette explore`. Every robot simulates
    its own body, or with --ros2 drives one over ROS 2. Exit status: 0 complete, 1 incomplete, 2 bad input,
    130 interrupted.
    """
    agreed = scheme_of(planner, scheme)
    world, specs = world_of(world_named(map_path, resolution), seed), team_named(team, robots, starts, drift)
    tell_unheeded(planner, len(specs), scheme, fusion=fusion, lease=processes.lease)
    if ros2 and unbounded:
        raise InputError("--unbounded: robots that run ROS 2 are never told how far it goes; leave it out")
    if ros2 and any(spec.sensor for spec in specs):
        raise InputError("sensor: simulated ROS 2 robots have lidars; leave it, or --ros2, out")
    if ros2 and any(spec.drift for spec in specs):
        raise InputError("drift: simulated ROS 2 robots know where they are; leave it, or --ros2, out")
    old = None if prior is None else str(prior.resolve())
    options = ExploreOptions(planner, agreed, fusion, return_home, area, unbounded, old, frames, rendezvous)
    options.check()
    lattice = options.lattice_on(world.frame)
    if prior is not None:
        read_prior(prior, lattice)  # what is wrong with it is told before anybody starts
    area_of = lattice.area
    places = choose_starts(world, specs, np.random.default_rng([seed, 1]), area_of)
    kind = Ros2Plan if ros2 else ExplorePlan
    plan = kind(world, specs, places, options, seed, processes.speed, processes.lease)
    given = orders_in(processes.orders)
    check_orders(given, world, specs, str(processes.orders), signed=fusion == "replicated")
    check_frames(given, frames, len(specs))
    page = ExploreOnlooker(world.name, [spec.name for spec in specs])
    run = processes.run(plan, max_time, page, given)
    setting = Setting(seed=seed, faults=processes.faults)
    EXPLORING.run(
        ExploreScene.of(world, [spec.name for spec in specs]),
        output,
        files_of(map_path, team, processes.faults, prior, processes.orders),
        lambda sinks, folder: run.watched_by(ExploreWatcher(plan, setting, sinks), folder),
    )


@team.command()
@tracking_options
@process_options
@output_options
def track(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str | None,
    fusion: str,
    objective: str | None,
    continuous: bool,
    max_time: float | None,
    processes: Processes,
    output: Output,
) -> None:
    """Let a team of agent processes follow the targets of SCENARIO: one process a vehicle.

    SCENARIO and the outputs are as for `vedette track`, the comparison left out. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    if coordination == "optimum":
        raise InputError("--coordination optimum: nobody on a network can work it out; see `vedette track`")
    scenario, name = scenario_of(scenario_path)
    size = len(scenario.vehicles)
    tell_unsaid(coordination, size, scheme, fusion=fusion, lease=processes.lease)
    tell_objective(objective, scenario.objective, default_scenario().objective)
    tell_duration(max_time, scenario.duration)
    options = TrackOptions(coordination, scheme, fusion, objective, continuous)
    plan = FlightsPlan("track", options, scenario_path, size, seed, processes.speed, processes.lease)
    vehicles = TrackTeam(scenario, options, plan.times)
    limit = scenario.duration + 1.0 if max_time is None else max_time
    page = TrackOnlooker(scenario, name)
    run = processes.fly(plan, limit, page, vehicles.grounds)
    setting, truth = Setting(seed=seed, faults=processes.faults), Targets.of(vehicles, seed)
    TRACKING.run(
        TrackScene.of(scenario, name),
        output,
        files_of(None, scenario_path, processes.faults, processes.orders),
        lambda sinks, folder: run.watched_by(TrackWatcher(vehicles, name, setting, truth.at, sinks), folder),
    )


@team.command()
@searching_options
@process_options
@output_options
def search(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str | None,
    fusion: str,
    max_time: float | None,
    processes: Processes,
    output: Output,
) -> None:
    """Let a team of agent processes look for the hidden target of SCENARIO: one process a vehicle.

    SCENARIO and the outputs are as for `vedette search`, counted curves and comparison left out. Exit
    status: 0 found, 1 not found in time or declared where it is not, 2 bad input, 130 interrupted.
    """
    case = case_of(scenario_path)
    size = len(case.names)
    tell_unsaid(coordination, size, scheme, fusion=fusion, lease=processes.lease)
    tell_duration(max_time, case.scenario.duration)
    options = SearchOptions(coordination, scheme, fusion)
    plan = FlightsPlan("search", options, scenario_path, size, seed, processes.speed, processes.lease)
    vehicles = SearchTeam(case, options, plan.times)
    duration = case.scenario.duration if max_time is None else min(max_time, case.scenario.duration)
    page = SearchOnlooker(case)
    run = processes.fly(plan, duration, page, vehicles.grounds)
    setting, hidden = Setting(seed=seed, faults=processes.faults), Hidden.of(case, seed)
    curves = ideal(case, floor(duration / case.scenario.step + 1e-6))
    SEARCHING.run(
        SearchScene.of(case, duration),
        output,
        files_of(None, scenario_path, processes.faults, processes.orders, *heat_maps(case, scenario_path)),
        lambda sinks, folder: run.watched_by(
            SearchWatcher(vehicles, duration, setting, hidden.at, curves, sinks), folder
        ),
    )


def _domain_command(declared: DomainEntry) -> click.Command:
    """Return ``vedette team NAME`` of a domain that is declared as one object."""

    def run(
        scenario_path: Path | None,
        seed: int,
        max_time: float | None,
        processes: Processes,
        output: Output,
        **how: Any,
    ) -> None:
        domain, options = declared.load(), DomainOptions(name=declared.name, **how)
        if options.coordination in declared.simulated:
            raise InputError(
                f"--coordination {options.coordination}: nobody on a network can work it out; see `vedette "
                f"{declared.name}`"
            )
        case = domain.case(scenario_path)
        size = len(case.names)
        tell_unsaid(options.coordination, size, options.scheme, fusion=options.fusion, lease=processes.lease)
        tell_duration(max_time, case.scenario.duration)
        plan = FlightsPlan("domain", options, scenario_path, size, seed, processes.speed, processes.lease)
        vehicles = domain.team(case, options, plan.times)
        limit = case.scenario.duration + 1.0 if max_time is None else max_time
        page = DomainOnlooker(domain, case)
        team_run = processes.fly(plan, limit, page, vehicles.grounds)
        setting = Setting(seed=seed, faults=processes.faults)
        kind_of(domain).run(
            domain.scene(case),
            output,
            (*files_of(None, scenario_path, processes.faults, processes.orders), *case.files),
            lambda sinks, folder: team_run.watched_by(
                DomainWatcher(domain, vehicles, setting, sinks), folder
            ),
        )

    about = (
        f"The mission of `vedette {declared.name}` by a team of agent processes: one process a vehicle.\n\n"
        f"SCENARIO and the outputs are the same, the comparison left out. {STATUS}"
    )
    command = click.command(declared.name, help=about, short_help=declared.line)
    return command(domain_options(declared)(process_options(output_options(run))))
