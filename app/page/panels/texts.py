"""The tab to read: About, for someone who sees the page for the first time."""

import viser

from app.language.spoken import language
from app.page.panels.head import WEB
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.scene.registry import ESTIMATORS
from solvers.scene.remedies import REMEDIES
from solvers.scene.step_bound import SAFE
from solvers.solver.soundness import CONTRADICTIONS, MOST_ERROR


def add_about(gui: viser.GuiApi) -> None:
    """Fill the tab: something to try, the page, each estimator behind its name, and what to believe."""
    gui.add_html((WEB / "try.html").read_text(encoding="utf-8"))
    about = (WEB / "about.html").read_text(encoding="utf-8")
    gui.add_html(about.format(problems="".join(view.about for view in VIEWS.values()),
                              divisions=", ".join(view.division for view in VIEWS.values())))
    for estimator in ESTIMATORS.values():
        with gui.add_folder(f"The estimator {estimator.title}", expand_by_default=False):
            gui.add_html(f"<div class='lab-about lab-explanation'>{estimator.explained(language())}</div>")
    rules = "".join(f"<li>{rule.sentence.format(size=f'more than {rule.most:g}')}</li>"
                    for rule in CONTRADICTIONS.values())
    remedies = ""
    for remedy in REMEDIES.values():
        titles = [problem.scene.TITLE for problem in PROBLEMS.values() if remedy.name in problem.scene.REMEDIES]
        only = f" ({', '.join(titles)} only)" * (len(titles) < len(PROBLEMS))
        remedies += f"<dt>{remedy.label}{only}</dt><dd>{remedy.explanation}.</dd>"
    trust = (WEB / "trust.html").read_text(encoding="utf-8")
    gui.add_html(trust.format(rules=rules, remedies=remedies, error=MOST_ERROR, safe=SAFE))
