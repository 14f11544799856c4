"""What can be fuzzed: a name, inputs to begin with, and what to do with an input."""

from __future__ import annotations

import contextlib
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.limits import limited_memory, limited_time
from tests.fuzz.mutation import Mutate

CORPUS = Path(__file__).parent / "corpus"
SOURCE = "vedette"


class Broken(AssertionError):
    """An input was refused and has changed something nevertheless, or was taken and cannot be told again."""


@dataclass(frozen=True)
class Defect:
    """What went wrong, and where: two of a kind with the same place count as one."""

    kind: str
    place: str  # the innermost lines of ours
    message: str

    @classmethod
    def of(cls, error: BaseException) -> Defect:
        """Return what an error tells."""
        frames = traceback.extract_tb(error.__traceback__)
        own = [frame for frame in frames if SOURCE in Path(frame.filename).parts] or frames
        place = " < ".join(f"{Path(f.filename).name}:{f.lineno}:{f.name}" for f in reversed(own[-3:]))
        return cls(type(error).__name__, place, str(error)[:300])

    def __str__(self) -> str:
        return f"{self.kind}: {self.message} [{self.place}]"


@dataclass(frozen=True)
class Target:
    """Something that reads bytes from others."""

    name: str
    seeds: Callable[[], list[bytes]]  # honest inputs
    read: Callable[[bytes], None]  # raises nothing for any input at all
    mutate: Mutate

    def check(self, data: bytes, memory: bool = True) -> Defect | None:
        """Let an input be read within the limits, that of memory if asked for; return what is wrong."""
        try:
            with limited_time(), limited_memory(len(data)) if memory else contextlib.nullcontext():
                self.read(data)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            return Defect.of(error)
        return None

    @property
    def kept(self) -> list[Path]:
        """Inputs that once broke something."""
        return sorted((CORPUS / self.name).glob("*"))
