"""Markdown to html without a network: formulas as MathML, inline pictures, instructions in the current language."""

import base64
import functools
import re
from pathlib import Path

import latex2mathml.converter
from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from mdit_py_plugins.dollarmath import dollarmath_plugin

from app.language.translation import lazy
from solvers.untrusted.quoting import one_line, quote

KINDS = {".svg": "image/svg+xml", ".png": "image/png"}
#: Instructions to the reader, by verb. The name is in bold, its value as code, and the name comes first.
SENTENCES = {"Press": lazy("Press {name}"), "Set": lazy("Set {name} to {value}"),
             "Choose": lazy("Choose {name} {value}")}
#: Fields of the scene by their widgets' labels.
FIELDS = {lazy("Cells"): "cells", lazy("Particles / cell"): "ppc", lazy("Amplitude A"): "amplitude",
          lazy("Modulus E"): "modulus", lazy("CFL number"): "cfl", lazy("Method"): "method",
          lazy("Body force"): "body_force"}


class RenderError(ValueError):
    """Raised for a formula or picture that cannot be shown. ``piece`` is its source in the text."""

    def __init__(self, piece: str, why: str):
        self.piece = piece
        super().__init__(one_line(why))


def to_html(markdown: str, folder: Path | None = None) -> str:
    """Converts Markdown to html, with html in it as text, and pictures from ``folder``; raises :class:`RenderError`."""
    return _make_parser(folder).render(markdown)


@functools.lru_cache(8)
def _make_parser(folder: Path | None) -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    parser.use(dollarmath_plugin, renderer=lambda latex, options: to_mathml(latex, options["display_mode"]),
               double_inline=True)

    def image(renderer: RendererHTML, tokens, index, options, environment) -> str:
        attributes = tokens[index].attrs
        attributes["src"] = _image_data_url(folder, str(attributes["src"]))
        return renderer.image(tokens, index, options, environment)

    parser.add_render_rule("image", image)
    return parser


def to_mathml(latex: str, display: bool) -> str:
    """Converts a LaTeX formula to MathML, as a block (``display``) or inline; raises :class:`RenderError`."""
    latex = latex.strip()
    try:
        found = latex2mathml.converter.convert(latex, display="block" if display else "inline")
    except Exception as error:  # the library raises any exception
        raise RenderError(latex, f"the formula ${quote(latex)}$ cannot be shown ({type(error).__name__}); "
                                 "give plain LaTeX such as $\\frac{h}{2}$") from None
    if unknown := re.search(r"\\\w+", found):  # an unknown command would be shown as typed
        raise RenderError(latex, f"the formula ${quote(latex)}$ has {quote(unknown[0])}, which cannot be "
                                 "shown; give plain LaTeX such as $\\frac{h}{2}$")
    return found


def _image_data_url(folder: Path | None, source: str) -> str:
    """Returns the picture with the relative path ``source`` in a folder as a data URL; raises :class:`RenderError`."""
    path = None if folder is None else folder / source
    kind = KINDS.get(Path(source).suffix)
    if kind is None or path is None or not re.fullmatch(r"[\w./-]+", source) or ".." in source or not path.is_file():
        raise RenderError(source, f"the picture {quote(source)} is not there; give an .svg or .png file beside "
                                  "the lesson")
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"
