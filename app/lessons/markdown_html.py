"""Markdown to html without a network: formulas as MathML, inline pictures, instructions in the current language."""

import base64
import functools
import html
import re
from pathlib import Path
from xml.etree import ElementTree

import latex2mathml.converter
from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from mdit_py_plugins.dollarmath import dollarmath_plugin

from app.language.translation import lazy
from solvers.untrusted.quoting import one_line, quote

KINDS = {".svg": "image/svg+xml", ".png": "image/png"}
#: What a formula may consist of. Links, classes and styles are missing on purpose: a lesson comes from anybody.
ELEMENTS = frozenset(("math menclose mfrac mi mn mo mover mpadded mphantom mroot mrow mspace msqrt mstyle msub msubsup "
                      "msup mtable mtd mtext mtr munder munderover").split())
ATTRIBUTES = frozenset(("accent columnalign columnlines columnspacing depth displaystyle fence form height largeop "
                        "linebreak linethickness lspace mathbackground mathcolor mathsize mathvariant maxsize minsize "
                        "movablelimits notation rowlines rowspacing rspace scriptlevel separator stretchy voffset "
                        "width").split())
VALUE = re.compile(r"[\w .,#%+-]*")
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
               allow_labels=False, double_inline=True)

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
        root = latex2mathml.converter.convert_to_element(latex, display="block" if display else "inline")
        for element in root.iter():  # the library writes letters as references, and would write all text as it is
            element.text = html.unescape(element.text or "")
        found = ElementTree.tostring(root, encoding="unicode")
    except Exception as error:  # the library raises any exception
        raise RenderError(latex, f"the formula ${quote(latex)}$ cannot be shown ({type(error).__name__}); "
                                 "give plain LaTeX such as $\\frac{h}{2}$") from None
    # An unknown command would be shown as typed.
    strange = (*re.findall(r"\\\w+", found), *(element.tag for element in root.iter() if element.tag not in ELEMENTS),
               *(f"{name}={value}" for element in root[0].iter() for name, value in element.items()
                 if name not in ATTRIBUTES or not VALUE.fullmatch(value)))
    if strange:
        raise RenderError(latex, f"the formula ${quote(latex)}$ has {quote(strange[0])}, which cannot be "
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
