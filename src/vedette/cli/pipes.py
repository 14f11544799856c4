"""Standard output and standard error whose readers may go away: a command goes on without them."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

from vedette.errors import InputError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


@contextmanager
def readers_may_leave(say: Callable[[str], None]) -> Iterator[None]:
    """Write to nowhere when the reader of standard output has left, as ``| head -1`` does, and say so once.

    When standard error has no reader either there is nobody to tell. Within, writing raises `InputError`
    where it fails otherwise, on a full disk for instance.
    """
    before = sys.stdout, sys.stderr
    sys.stderr = _patient(sys.stderr, lambda: None)
    sys.stdout = _patient(sys.stdout, lambda: say("nobody reads standard output any more; going on without"))
    try:
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                with suppress(InputError):
                    stream.flush()
        sys.stdout, sys.stderr = before


class _Pipe(io.FileIO):
    """A file descriptor whose reader may leave."""

    def __init__(self, descriptor: int, left: Callable[[], None]) -> None:
        super().__init__(descriptor, "w", closefd=False)
        self._left = left

    def write(self, data: ReadableBuffer) -> int:
        """Write; without a reader to nowhere, from then on.

        Raises:
            InputError: that fails, and will not be tried again.
        """
        if not memoryview(data).nbytes:  # as those write who want to know whether this takes bytes
            return 0
        try:
            return super().write(data)
        except OSError as error:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())
            os.close(nowhere)
            if not isinstance(error, BrokenPipeError):
                raise InputError(f"cannot write to standard output: {error.strerror}") from error
        self._left()
        return super().write(data)


def _patient(stream: TextIO, left: Callable[[], None]) -> TextIO:
    """Return a stream to the same place; what is no file stays as it is."""
    inner: object = getattr(stream, "buffer", None)
    if not isinstance(stream, io.TextIOWrapper) or not isinstance(inner, (io.BufferedWriter, io.FileIO)):
        return stream
    stream.flush()
    pipe = _Pipe(stream.fileno(), left)
    return io.TextIOWrapper(
        pipe if isinstance(inner, io.FileIO) else io.BufferedWriter(pipe),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
