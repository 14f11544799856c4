"""``python -m tests.support.bad_agent MODE agent CONFIG.yaml ...``: ``vedette``, misbehaving in one way.

``slow=SECONDS`` takes so long for every job, ``ends=SIGNAL`` gets a signal in the middle of a round,
``late=SECONDS`` starts so late, the clock of ``stepped=SECONDS`` jumps by so much after ten; the others are
the modes of ``tests.support.lies``, but for ``double``.
"""

from __future__ import annotations

import signal
import sys
import time
from functools import partial
from typing import Any

import numpy as np

from tests.support import misbehaving
from tests.support.lies import MODES
from vedette.cli import main
from vedette.missions.explore.assemble import assemble
from vedette.net import start
from vedette.net.explore import robot
from vedette.net.process import AgentProcess

STEPPED_AFTER = 10.0  # [s]


def misbehave(mode: str) -> None:
    """Let this process's robot misbehave."""
    what, _, how = mode.partition("=")
    if what == "late":
        time.sleep(float(how))
    elif what == "stepped":
        _step_the_clock(float(how))
    elif what == "ends":
        number = signal.Signals[how]
        start.NetworkedAgent = partial(misbehaving.Ending, number=number)  # type: ignore[attr-defined,misc]
    elif what == "slow":
        run = AgentProcess._run

        def slowly(self: AgentProcess, job: Any) -> None:
            time.sleep(float(how))
            run(self, job)

        AgentProcess._run = slowly  # type: ignore[method-assign]
    else:
        program = MODES[mode].program(np.random.default_rng(0))
        start.NetworkedAgent = partial(program)  # type: ignore[attr-defined,misc]
        robot.assemble = partial(assemble, explorer=MODES[mode].explorer)  # type: ignore[attr-defined]


def _step_the_clock(seconds: float) -> None:
    """Let the time of day jump, once; the clock that never goes back goes on as it did."""
    real, at = time.time, time.monotonic() + STEPPED_AFTER

    def stepped() -> float:
        return real() + (seconds if time.monotonic() > at else 0.0)

    time.time = stepped


if __name__ == "__main__":
    misbehave(sys.argv.pop(1))
    main()
