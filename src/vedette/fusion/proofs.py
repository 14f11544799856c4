"""Whether what somebody says to prove is proof: checked by whoever receives it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from vedette.fusion.contradictions import Histories, Twice, Words
from vedette.fusion.seals import EVIDENCE, STEPS, Notary
from vedette.fusion.steps.sealed import SealedLog
from vedette.fusion.steps.wire import parts

NOTHING = "what it says to prove contradicts nothing"

Subject = Callable[[Words], tuple[Any, ...]]  # robot and the rest of what a word is about; ValueError


def of_version(words: Words) -> tuple[Any, ...]:
    """Return whose version of evidence a seal is about, and which."""
    kind, robot, boot, version, *_ = words
    return robot, kind, boot, version


SUBJECTS: Mapping[str, Subject] = {EVIDENCE: of_version, STEPS: of_version}


def check_twice(proof: Twice, notary: Notary, robot: int, subjects: Mapping[str, Subject]) -> None:
    """Raise ValueError unless a robot has signed two words about one thing."""
    about = [_subject(word.what, subjects) for word in (proof.first, proof.second)]
    if about[0] != about[1] or about[0][0] != robot or proof.first.what == proof.second.what:
        raise ValueError(NOTHING)
    for word in (proof.first, proof.second):
        word.check(notary, robot)


def _subject(words: Words, subjects: Mapping[str, Subject]) -> tuple[Any, ...]:
    kind = words[0] if words else ""
    if not isinstance(kind, str) or kind not in subjects:
        raise ValueError("a word of unknown kind")
    return subjects[kind](words)


def check_histories(proof: Histories, notary: Notary, robot: int) -> None:
    """Raise ValueError unless a robot has signed a log that does not begin with what it had signed before."""
    for word in (proof.early, proof.late):
        word.check(notary, robot)
    entries = [part.entry for part in parts(proof.entries)]
    (*early_log, early, _, root), (*late_log, late, _, later) = proof.early.what, proof.late.what
    if early_log != late_log or early_log[:2] != [STEPS, robot] or late != len(entries):
        raise ValueError(NOTHING)
    log, roots = SealedLog(), dict[Any, bytes]()
    for number, entry in enumerate(entries, 1):
        log.append(entry)
        roots[number] = log.root
    if roots.get(late) != later or roots.get(early, root) == root:
        raise ValueError(NOTHING)
