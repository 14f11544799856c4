"""Formulas as MathML, made when the site is built: browsers show them without a script or a network."""

from __future__ import annotations

from docutils import nodes
from math_core import LatexToMathML
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

CONVERTER = LatexToMathML()


def setup(app: Sphinx) -> dict[str, bool]:
    """Take over from MathJax."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def visit_inline(page: HTML5Translator, node: nodes.math) -> None:
    """Write a formula into its line."""
    page.body.append(CONVERTER.convert_with_local_state(node.astext(), displaystyle=False))
    raise nodes.SkipNode


def visit_block(page: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula on a line of its own, with the number that ``\\tag`` gives it at the margin."""
    latex = node.astext()
    if r"\tag" in latex:
        latex = rf"\begin{{equation}}{latex}\end{{equation}}"
    page.body.append('<div class="formula">')
    page.body.append(CONVERTER.convert_with_local_state(latex, displaystyle=True))
    page.body.append("</div>\n")
    raise nodes.SkipNode
