"""The command of a domain that is declared as one object, and what it shares with that of a team."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.options import Output, fault_options, orders_option, output_options, with_options
from vedette.cli.running import Kind, simulate, simulate_watched
from vedette.cli.vehicles import Adding, vehicle_options
from vedette.cli.windows import beside_of, watch_options, watched
from vedette.missions.flights import FUSIONS
from vedette.run.domain import DomainMission
from vedette.sim.domain import Domain
from vedette.sim.domains import DomainEntry
from vedette.window.explore import Shower
from vedette.window.picture import Picture

STATUS = "Exit status: 0 complete, 1 incomplete, 2 bad input, 130 interrupted."


def kind_of(domain: Domain[Any, Any, Any, Any, Any]) -> Kind[Any, Any, Any]:
    """Return what is shown, recorded, written and said of its missions."""
    return Kind(domain.display, domain.recorder, domain.write, domain.closing, tuple(domain.leaves))


def domain_options(domain: DomainEntry) -> Adding:
    """``SCENARIO`` and what says how its vehicles work together."""
    return vehicle_options(domain.seeds, domain.coordinations, FUSIONS)


def command_of(declared: DomainEntry) -> click.Command:
    """Return ``vedette NAME``."""

    def run(
        scenario_path: Path | None,
        orders: Path | None,
        output: Output,
        watch: bool,
        pace: float,
        no_compare: bool,
        **options: Any,
    ) -> None:
        domain = declared.load()
        mission = DomainMission(domain, scenario_path, orders=orders or (), **options)
        beside = (lambda report, say: report) if no_compare else mission.compared
        kind = kind_of(domain)
        if not watch:
            simulate(kind, mission, mission.scene, output, beside)
        from vedette.window.declared import pictures  # who watches nothing does not wait for it

        hub, names = watched(mission, mission.scene.name), mission.scene.vehicles
        draw = pictures(mission.scene)

        def drawn(snapshot: Any) -> Picture:
            return draw(snapshot, beside_of(mission, names, output.out))

        shower = Shower[Any](hub, drawn, pace)
        simulate_watched(kind, mission, mission.scene, output, hub, shower, beside)

    no_compare = click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
    options = orders_option(fault_options(output_options(watch_options(with_options(run, no_compare)))))
    about = f"{declared.about}\n\n{STATUS}"
    return click.command(declared.name, help=about)(domain_options(declared)(options))
