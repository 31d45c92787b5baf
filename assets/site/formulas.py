"""Formulas, by the library that the lab's own page shows them with: MathML, for which a browser fetches nothing."""

from typing import Any

from docutils import nodes
from sphinx.util import logging

from app.lessons.markdown_html import RenderError, to_mathml

LOG = logging.getLogger(__name__)


def setup(app: Any) -> dict:
    """Make the renderer known; conf.py chooses it."""
    app.add_html_math_renderer("latex2mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def inline(translator: Any, node: nodes.Node) -> None:
    """A formula in a line."""
    translator.body.append(_shown(node, display=False))
    raise nodes.SkipNode


def block(translator: Any, node: nodes.Node) -> None:
    """A formula on lines of its own."""
    translator.body.append(f"<div class='formula'>{_shown(node, display=True)}</div>")
    raise nodes.SkipNode


def _shown(node: nodes.Node, display: bool) -> str:
    try:
        return to_mathml(node.astext(), display)
    except RenderError as error:
        LOG.warning("%s", error, location=node)
        return ""
