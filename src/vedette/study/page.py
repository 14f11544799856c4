"""One HTML page that needs nothing else: pictures are inside it, and it is read without JavaScript."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from pathlib import Path

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #282a2e; background: #fff;
       max-width: 78rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .6rem; border-bottom: 1px solid #d8dbde; padding-bottom: .2rem; }
h3 { font-size: 1.02rem; margin: 1.4rem 0 .4rem; }
p { max-width: 60rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums; margin: .5rem 0; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { padding: .22rem .65rem; border-bottom: 1px solid #ebedf0; text-align: right; white-space: nowrap; }
th { border-bottom: 1px solid #96999d; vertical-align: bottom; }
th.l, td.l { text-align: left; }
tr.faint td { color: #6e7175; font-style: italic; }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { color: #6e7175; font-size: .88rem; max-width: 60rem; }
pre { background: #f5f6f7; padding: .8rem 1rem; overflow-x: auto; font-size: .84rem; }
code { background: #f5f6f7; padding: 0 .2rem; }
.warning { border-left: 4px solid #d55e00; padding: .1rem .9rem; background: #fdf3ec; }
"""


def page(title: str, parts: Sequence[str]) -> str:
    """Return the text of a page; the parts are HTML, made by the functions below."""
    body = "\n".join(parts)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n{body}\n</body>\n</html>\n"
    )


def heading(text: str, level: int = 2) -> str:
    """Return a heading of a section, or of a part of one."""
    return f"<h{level}>{escape(text)}</h{level}>"


def paragraph(text: str, warning: bool = False) -> str:
    """Return a paragraph; words between backquotes are code."""
    pieces = escape(text, quote=False).split("`")
    marked = "".join(f"<code>{piece}</code>" if i % 2 else piece for i, piece in enumerate(pieces))
    return f'<p class="warning">{marked}</p>' if warning else f"<p>{marked}</p>"


def bullets(items: Sequence[str]) -> str:
    """Return a list."""
    return "<ul>" + "".join(f"<li>{escape(item, quote=False)}</li>" for item in items) + "</ul>"


def verbatim(text: str) -> str:
    """Return text as it stands."""
    return f"<pre>{escape(text, quote=False)}</pre>"


def table(
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    left: int = 1,
    caption: str = "",
    faint: Sequence[int] = (),
) -> str:
    """Return a table of text.

    Args:
        header: names of the columns.
        rows: a text for each column.
        left: so many columns are words, on the left; the others are numbers.
        caption: over the table; none if empty.
        faint: rows that are there for comparison only.
    """

    def line(cells: Sequence[str], tag: str, faded: bool = False) -> str:
        marked = (
            f"<{tag}{' class=l' if i < left else ''}>{escape(cell, quote=False)}</{tag}>"
            for i, cell in enumerate(cells)
        )
        return f"<tr{' class=faint' if faded else ''}>{''.join(marked)}</tr>"

    over = f"<caption>{escape(caption)}</caption>" if caption else ""
    body = "\n".join(line(row, "td", i in faint) for i, row in enumerate(rows))
    return (
        f'<div class="scroll"><table>{over}<thead>{line(header, "th")}</thead>\n'
        f"<tbody>{body}</tbody></table></div>"
    )


def picture(png: Path, caption: str) -> str:
    """Return a picture, held by the page itself."""
    data = base64.b64encode(png.read_bytes()).decode("ascii")
    return (
        f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(caption, quote=False)}</figcaption></figure>"
    )
