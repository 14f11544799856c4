"""How every command runs a mission: shown live and recorded, its files written, its end told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NoReturn, TypeVar

import click

from vedette.cli.ends import telling_what_is_missing
from vedette.cli.options import Output
from vedette.cli.windows import linger, opened
from vedette.errors import InputError
from vedette.interrupt import ending_on_ctrl_c
from vedette.record.display import Display
from vedette.record.folder import OutputFolder
from vedette.record.log import MissionScene, Sink, Timed
from vedette.record.mcap import Place
from vedette.record.summary import MissionSummary
from vedette.run.mission import RECORD, StepwiseMission
from vedette.run.result import MissionReport
from vedette.window.hub import Hub

SceneT = TypeVar("SceneT", bound=MissionScene)
SnapshotT = TypeVar("SnapshotT", bound=Timed)
ReportT = TypeVar("ReportT", bound=MissionReport)
Say = Callable[[str], None]


@dataclass(frozen=True)
class Kind(Generic[SceneT, SnapshotT, ReportT]):
    """What is shown, recorded, written and said of missions of one domain."""

    display: Callable[[SceneT, bool], Display[SnapshotT]]
    recorder: Callable[[Place, SceneT], AbstractContextManager[Sink[SnapshotT]]]
    write: Callable[[ReportT, OutputFolder, bool], None]
    closing: Callable[[Any, Path], list[str]]  # takes the summary
    leaves: tuple[str, ...]  # names of the files that a mission leaves

    def run(
        self,
        scene: SceneT,
        output: Output,
        inputs: Sequence[Path],
        play: Callable[[Sequence[Sink[SnapshotT]], OutputFolder], ReportT],
        beside: Callable[[ReportT, Say], ReportT] = lambda report, say: report,
    ) -> NoReturn:
        """Run a mission, and leave with its outcome's status.

        Args:
            scene: of the mission; everything that can be wrong with its input has been found.
            output: where results go.
            inputs: files that it has been read from.
            play: runs it, followed by the sinks; there is a folder for more.
            beside: adds to the report what is worked out afterwards, and says so.
        """
        leaves = [*self.leaves, *(["mission.gif"] if output.animate else [])]
        with (
            OutputFolder.make(output.out, output.force, scene.name, inputs) as folder,
            telling_what_is_missing(folder, leaves),
        ):
            report, unkept = None, None
            try:
                with ExitStack() as sinks:
                    live = sinks.enter_context(self.display(scene, output.as_json))
                    record = sinks.enter_context(self.recorder(lambda: folder / RECORD, scene))
                    report = play((live, record, folder), folder)
            except InputError as error:
                if report is None:
                    raise
                unkept = (
                    error  # the record alone cannot be written: what has been found out is kept all the same
                )
            report = beside(report, live.say)
            self.write(report, folder, output.animate)
            closed = self.closing(report.summary, folder.path)
        if unkept is not None:
            raise unkept
        end(report.summary, closed, output.as_json)


def simulate(
    kind: Kind[SceneT, SnapshotT, ReportT],
    mission: StepwiseMission[SnapshotT, Any, Any, ReportT],
    scene: SceneT,
    output: Output,
    beside: Callable[[ReportT, Say], ReportT] = lambda report, say: report,
    more: Sequence[Sink[SnapshotT]] = (),
) -> NoReturn:
    """Run a simulated mission as `Kind.run` does; the first Ctrl-C ends it in good order, a second aborts.

    ``more`` sinks follow it.
    """
    with ending_on_ctrl_c(mission.stop):
        kind.run(scene, output, mission.inputs, lambda sinks, folder: mission.play([*sinks, *more]), beside)


def simulate_watched(
    kind: Kind[SceneT, SnapshotT, ReportT],
    mission: StepwiseMission[SnapshotT, Any, Any, ReportT],
    scene: SceneT,
    output: Output,
    hub: Hub,
    shower: Sink[SnapshotT],
    beside: Callable[[ReportT, Say], ReportT] = lambda report, say: report,
) -> NoReturn:
    """Run a simulated mission as `simulate` does, shown in a browser, where it stays until Ctrl-C."""
    with opened(hub):
        try:
            simulate(kind, mission, scene, output, beside, [shower])
        finally:
            hub.close()
            if not mission.stopped:
                click.echo("the mission is over; the page stays until Ctrl-C", err=True)
                linger()


def end(summary: MissionSummary, lines: Sequence[str], as_json: bool) -> NoReturn:
    """Print the summary alone, or lines for people, and leave with the outcome's status."""
    outcome = summary.outcome
    if as_json:
        click.echo(summary.to_json(), nl=False)
    else:
        gone = (("lost", summary.lost), ("left", summary.left))
        lost = [f"{fate} on the way: {', '.join(names)}" for fate, names in gone if names]
        why = [] if outcome.completed else [f"why it ended: {outcome.meaning}"]
        click.echo("\n".join([*lines, *lost, *why]))
    raise SystemExit(outcome.status)
