"""Mermaid's diagrams as SVG, drawn when the site is built."""

from __future__ import annotations

import mermaidx
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class Mermaid(SphinxDirective):
    """A fenced block in Mermaid's language."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the drawing, with a name that is its own on the page."""
        svg = mermaidx.render("\n".join(self.content)).svg()
        svg = svg.replace("my-svg", f"diagram-{self.env.new_serialno('diagram')}")
        return [nodes.raw("", f'<figure class="diagram">{svg}</figure>', format="html")]


def setup(app: Sphinx) -> dict[str, bool]:
    """Draw the blocks that are fenced as ``mermaid``."""
    app.add_directive("mermaid", Mermaid)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
