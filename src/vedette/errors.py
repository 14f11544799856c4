"""What a user can get wrong: an exception for what cannot be, a warning for what may be meant otherwise."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping

from vedette.number import is_number

Limits = tuple[float, float, str]  # lowest, highest, unit


class InputError(ValueError):
    """Bad input, told in one line that names the file or field, the value and the remedy.

    The command line prints the line and exits with status 2; a library caller sees a ``ValueError``.
    """


class PartError(InputError):
    """A part of somebody's own raises, or returns what cannot be: its author's fault, no sender's."""


class InputWarning(UserWarning):
    """Input that can be used but may be meant otherwise, told in one line as an `InputError` is.

    The command line prints the line, once, and goes on; a library caller sees a warning.
    """


def nearest_name(name: str, known: Iterable[str]) -> str:
    """Return ``" (did you mean 'x'?)"`` for the known name most like ``name``, or list them all."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    return f"did you mean {close[0]!r}?" if close else f"known: {', '.join(known) or 'none'}"


def check_word(what: str, word: str, known: Collection[str]) -> None:
    """Raise InputError for a word that is none of those known."""
    if not isinstance(word, str) or word not in known:
        raise InputError(f"unknown {what} {brief(word)}; {nearest_name(str(word), known)}")


def check_limits(thing: object, limits: Mapping[str, Limits]) -> None:
    """Raise InputError for the first of these fields that is not within its limits, the ends included."""
    for field, (low, high, unit) in limits.items():
        value = getattr(thing, field)
        if not is_number(value) or not low <= value <= high:
            span, got = f"{low:g} to {high:g} {unit}".rstrip(), value if is_number(value) else brief(value)
            raise InputError(f"{field} must be {span}; got {got}")


def brief(value: object, limit: int = 120) -> str:
    """Return what ``repr`` tells of a value, on one line, cut where it is long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= limit else f"{text[: limit - 3]}..."
