"""Finds what is to be read on a page outside the catalogue: in the language of ``tests/support/pseudo_translation.py``
every text of the code stands between two brackets, and what does not has not been asked for."""

from __future__ import annotations

import re

from solvers.scene.estimator_registry import ESTIMATORS

#: Words that every language has: names of the lab, of methods, estimators and people, and units.
NAMES = ("mpm-lab", "mpm", "uGIMP", "cpGIMP", "GIMP", "CPDI", "B-splines?", "CFL", "RMS", "GCI", "Xing", "Stern",
         "kPa", "MPa", "GPa", "min", "mm/s", "Esc", *map(re.escape, ESTIMATORS))
#: What is not for reading, or is no word: code and formulas; texts through which scripts and the server talk; what the
#: viewer has and never shows here; and the estimators' explanations, a file in each language. Nor is what says itself
#: that it is in another language: the lessons' own text, languages' names, long texts that are English so far.
NOT_READ = ("script, style, template, code, kbd, math, noscript, [data-lab~=lab-store] + div, .lab-explanation,"
            " .lab-lines, [data-mantine-shared-portal-node], .mantine-Notification-root, .u-legend, [data-dock-header],"
            " [data-dock-griphandle]")
ATTRIBUTES = ("title", "aria-label", "placeholder", "alt", "aria-valuetext", "data-says", "data-words", "data-waits",
              "data-answer")
#: All texts, each with all of its block, for a sentence may have parts in italics: of each what is outside brackets.
OUTSIDE = """([skip, attributes]) => {
  const found = [], blocks = new Map();
  const add = (where, text) => {
    let depth = 0, rest = "";
    for (const sign of text) {
      if (sign === "⟦") depth += 1; else if (sign === "⟧") depth -= 1; else if (depth <= 0) rest += sign;
    }
    found.push([where, rest]);
  };
  const inline = element => element.parentElement && !element.matches("text, tspan, button, [class*=Button-label]")
    && ["inline", "contents"].includes(getComputedStyle(element).display);
  const html = document.documentElement, foreign = element => element.closest("[lang]").lang !== html.lang;
  const unread = element => element.closest(skip) || foreign(element) || !element.checkVisibility();
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; node = walk.nextNode();) {
    let block = node.parentElement;
    if (unread(block)) continue;
    while (inline(block)) block = block.parentElement;
    blocks.set(block, (blocks.get(block) || "") + node.data);
  }
  for (const [block, text] of blocks) add(block.className?.baseVal ?? block.className ?? block.tagName, text);
  for (const name of attributes)
    for (const element of document.querySelectorAll(`[${name}]`))
      if (!unread(element)) add(name, element.getAttribute(name));
  for (const input of document.querySelectorAll("input[role=combobox], input[aria-haspopup=listbox]"))
    if (!unread(input)) add("chosen", input.value);
  for (const name of [...html.style]) if (name.startsWith("--says-"))
    add(name, getComputedStyle(html).getPropertyValue(name));
  return found;
}"""


NAME = re.compile(rf"(?<!\w)(?:{'|'.join(NAMES)})(?!\w)", re.IGNORECASE)
BRACKETS = re.compile("⟦[^⟦⟧]*⟧")


def words_of(text: str) -> str:
    """What is said outside brackets; "" where that is no word."""
    while BRACKETS.search(text):
        text = BRACKETS.sub("", text)
    return text.strip() if re.search(r"[^\W\d_]{3,}", NAME.sub("", text)) else ""


def outside(page) -> dict[str, str]:
    """Words that are outside brackets, by the texts in which they are: each with where it is."""
    said = page.evaluate(OUTSIDE, [NOT_READ, ATTRIBUTES])
    return {text.strip()[:200]: where for where, text in said if words_of(text)}
