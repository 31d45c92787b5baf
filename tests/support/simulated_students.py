"""Pupils of a class without browsers: they come by the class code, go through a paced lesson, and keep all that they
are told, so that a test can look through it."""

import json
import re

from tests.app.serving.test_class_code import enter
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

WHERE = re.compile(r"<div>(introduction|the end|step (\d+) of \d+)</div>")


def cookie_of(address, code):
    """The cookie that a code gives to one who comes for the first time."""
    return enter(address, code)[2][1]


class Student(RawClient):
    """One page of a browser that has this cookie. ``told`` is everything that it was ever told, as text."""

    def __init__(self, address, cookie, **options):
        self.told, self.gone = [], set()
        super().__init__(address, {"Cookie": cookie}, **options)

    @property
    def at(self):
        """The step that is shown, 0 for the introduction."""
        heads = [found for text in self.html.copy().values() if (found := WHERE.search(text))]
        return None if not heads else 0 if heads[-1][1] == "introduction" else int(heads[-1][2] or 999)

    def off(self, label):
        """Whether this button is there and cannot be pressed."""
        return self.widgets[self.find(label)]["props"]["disabled"]

    def go_on(self):
        """Press Next, once it is free, and wait for what follows."""
        before = self.at
        wait_until(lambda: not self.off("Next"), "Next free")
        self.set(self.find("Next"), True)
        wait_until(lambda: self.at == before + 1, f"the step after {before}")

    def tell(self, **said):
        """What a browser tells of itself."""
        self.set(self.find("kept by the browser"), json.dumps(said))

    def answer(self, step, given, button=""):
        """Give an answer to the step that is shown, and have it recorded."""
        button = self.find(button or ("Record my prediction" if step.kind == "predict" else "Check my answer"))
        if step.asked_question.kind == "choice":
            self.tell(choice=[step.key, given])
        else:
            texts = [name for label, name in self._labels().items() if label and label.startswith(
                ("At least", "At most") if step.asked_question.kind == "interval" else "Answer")]
            for text, part in zip(texts, given if isinstance(given, list) else [given], strict=True):
                self.set(text, str(part))
        self.set(button, True)
        wait_until(lambda: self.said("Your answer") or self.said("Please "), "the answer heard")
        if not self.said("Your answer"):  # what was chosen and the button that was pressed are heard by two threads
            self.set(button, True)
            wait_until(lambda: self.said("Your answer"), "the answer taken")

    def said(self, words):
        """Whether these stand below the question."""
        return any("lab-recorded" in text and words in text for text in self.html.copy().values())

    def _hear(self, message):
        if message["type"] == "GuiRemoveMessage":
            self.html.pop(message["uuid"], None)
        else:
            self.told.append(str(message))
        super()._hear(message)
