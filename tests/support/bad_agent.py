"""``python -m tests.support.bad_agent MODE agent CONFIG.yaml ...``: ``vedette``, misbehaving in one way.

``slow=SECONDS`` takes so long for every job; the others are the modes of ``tests.support.bad_member``.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from typing import Any

import numpy as np

from tests.support.bad_member import MODES
from vedette.cli import main
from vedette.net import start
from vedette.net.process import AgentProcess


def misbehave(mode: str) -> None:
    """Let this process's robot misbehave."""
    if mode.startswith("slow="):
        run = AgentProcess._run

        def slowly(self: AgentProcess, job: Any) -> None:
            time.sleep(float(mode.removeprefix("slow=")))
            run(self, job)

        AgentProcess._run = slowly  # type: ignore[method-assign]
    else:
        program = MODES[mode](np.random.default_rng(0))
        start.NetworkedAgent = partial(program)  # type: ignore[attr-defined,misc]


if __name__ == "__main__":
    misbehave(sys.argv.pop(1))
    main()
