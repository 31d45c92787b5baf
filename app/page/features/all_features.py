"""The features of a page, in the order in which they are built, get the keyboard's focus and may take the stage."""

from app.page.feature import Feature
from app.page.features.board.lecturer_panel import LecturerBoardPanel
from app.page.features.body.panel import BodyPanel
from app.page.features.budget.panel import BudgetPanel
from app.page.features.cost.panel import CostTab
from app.page.features.lesson.panel import LessonPlayer
from app.page.features.opening_tour import OpeningTour
from app.page.features.sharing import Sharing
from app.page.features.slow_motion import SlowMotion
from app.page.features.suggestions import Suggestions
from app.page.features.undo import Undo
from app.page.features.upload.panel import UploadPanel

FEATURES: tuple[type[Feature], ...] = (
    UploadPanel, BodyPanel, SlowMotion, BudgetPanel, LessonPlayer, CostTab, Sharing, OpeningTour, Suggestions, Undo,
    LecturerBoardPanel)
