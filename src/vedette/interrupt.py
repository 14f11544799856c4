"""Ctrl-C, SIGTERM and SIGHUP end a command in good order."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def ending_on_any_signal() -> Iterator[None]:
    """Let SIGTERM and SIGHUP do what Ctrl-C does, unless they are ignored, as ``nohup`` has it.

    Whoever runs a program sees to that, never a library: it is for the main thread of a command.
    """
    before = {number: signal.getsignal(number) for number in ENDINGS if number != signal.SIGINT}
    with _handling({n: signal.default_int_handler for n, old in before.items() if old is signal.SIG_DFL}):
        yield


@contextmanager
def ending_on_ctrl_c(stop: Callable[[], None]) -> Iterator[None]:
    """Let the first Ctrl-C call ``stop``, which ends the mission in good order; a second one aborts.

    So do the signals that do what Ctrl-C does. Only the main thread may see to that, and whoever has Ctrl-C
    in hand already keeps it.
    """
    before = {number: signal.getsignal(number) for number in ENDINGS}
    held = [number for number, old in before.items() if old is signal.default_int_handler]
    if before[signal.SIGINT] in (signal.SIG_DFL, signal.SIG_IGN):
        held.append(signal.SIGINT)

    def interrupted(*_: object) -> None:
        for number in held:
            signal.signal(number, _abort)
        stop()

    if threading.current_thread() is not threading.main_thread() or signal.SIGINT not in held:
        yield
        return
    with _handling(dict.fromkeys(held, interrupted)):
        yield


def _abort(*_: object) -> NoReturn:
    raise KeyboardInterrupt


@contextmanager
def _handling(handlers: dict[signal.Signals, Callable[..., Any]]) -> Iterator[None]:
    """Handle signals so, and afterwards as before."""
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
