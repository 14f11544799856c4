"""What targets are called in pictures and on the screen where there is no room for their names."""

from __future__ import annotations

from string import ascii_letters


def letter(target: int) -> str:
    """Return a target's letter, by its index: a to z, A to Z, and from the start again."""
    return ascii_letters[target % len(ascii_letters)]
