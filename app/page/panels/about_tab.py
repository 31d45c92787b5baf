"""The About tab, for first-time visitors."""

from html import escape

import viser

from app.language.translation import ENGLISH, current_language, localised_path, tr
from app.page.panels.page_header import WEB, language_links
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.stabilisations import REMEDIES
from solvers.scene.step_bound import SAFE
from solvers.solver.soundness import CONTRADICTIONS, LOST_FROM


def add_about(gui: viser.GuiApi) -> None:
    """Adds the texts of the About tab: introduction, problems, a folder for each estimator, and their reliability."""
    gui.add_html(_text("try.html"))
    gui.add_html(_text("about.html").format(problems="".join(view.about for view in VIEWS.values()),
                                            divisions=", ".join(escape(tr(view.division)) for view in VIEWS.values())))
    for estimator in ESTIMATORS.values():
        with gui.add_folder(tr("The estimator {title}", title=estimator.title), expand_by_default=False):
            gui.add_html(f"<div class='lab-about lab-explanation'>{estimator.explanation_in(current_language())}</div>")
    own = "" if current_language() == ENGLISH else f" lang='{current_language()}'"  # the parent may be English
    rules, remedies = "", ""
    for rule in CONTRADICTIONS.values():
        size = tr("more than {most:g}", most=rule.most)
        rules += f"<li{own}>{tr(rule.sentence, size=size)}</li>"
    for remedy in REMEDIES.values():
        titles = [escape(tr(problem.scene.TITLE)) for problem in PROBLEMS.values()
                  if remedy.name in problem.scene.REMEDIES]
        label = tr(remedy.label)
        if len(titles) < len(PROBLEMS):
            label = tr("{label} ({problems} only)", label=label, problems=", ".join(titles))
        remedies += f"<dt{own}>{label}</dt><dd{own}>{tr(remedy.explanation)}.</dd>"
    gui.add_html(_text("trust.html").format(rules=rules, remedies=remedies, error=LOST_FROM, safe=SAFE))
    gui.add_html(f"<div class='lab-about lab-languages'>{language_links()}</div>")


def _text(name: str) -> str:
    """Returns the html file of this name in ``web/``, in the page's language or else marked as English."""
    path = localised_path(WEB / name)
    text = path.read_text(encoding="utf-8")
    return text if current_language() == ENGLISH or path.name != name else f"<div lang='{ENGLISH}'>{text}</div>"
