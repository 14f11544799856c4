"""A word in a signature leads to what it means where it is written, not to whatever else is called so."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Iterator
from types import ModuleType

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at every page once it is read."""
    app.connect("doctree-read", qualify)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def qualify(app: Sphinx, page: nodes.document) -> None:
    """Let a bare word for a type lead to what Python finds by it, and nowhere if that is nothing."""
    for reference in [*page.findall(addnodes.pending_xref)]:
        word = reference["reftarget"]
        if reference.get("refdomain") != "py" or "." in word:
            continue
        found = [vars(module)[word] for module in modules(reference) if word in vars(module)]
        if found and hasattr(found[0], "__qualname__"):
            reference["reftarget"] = f"{found[0].__module__}.{found[0].__qualname__}"
        elif reference["reftype"] == "class":
            reference.replace_self(reference.children)


def modules(reference: addnodes.pending_xref) -> Iterator[ModuleType]:
    """Yield where a word may have its meaning from: its module, those of its class's bases, the built-ins."""
    here = sys.modules.get(reference.get("py:module") or "")
    if here is not None:
        yield here
        owner = getattr(here, reference.get("py:class") or "", None)
        yield from (sys.modules[base.__module__] for base in getattr(owner, "__mro__", ()))
    yield builtins
