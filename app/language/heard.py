"""Sentences of the solvers, and of links that cannot be read, in the visitor's language. They are composed in English,
often in another process, and come here as they are: which of the catalogue's templates a sentence is made of is found
by its words, and what stands in the places of that template is looked for in the same way. Of several ways to
understand it the one counts that understands the most letters."""

import functools
import re
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import NamedTuple

from app.language.spoken import ENGLISH, catalogue, kept, language

PLACES = ("solvers/", "app/state.py")  # where such sentences are made
LONGEST = 1000  # characters of a sentence: none of ours is as long
MOST_WAYS = 30  # to put a sentence into a template that are tried
MOST_TEXTS, DEEPEST = 500, 20  # that are looked up for one sentence: one that quotes from outside may have any number
SEPARATORS = re.compile(r"; |: |, | \(")  # between what a sentence is made of where no template says so
PLACE, WORD = re.compile(r"\{(\w+)\}"), re.compile(r"[^\W\d_]{2,}")


class Understood(NamedTuple):
    """A text in another language, and how many of its letters were ``known``."""

    known: int
    said: str


class Looked:
    """What has been looked up of a sentence, and how deep within it one is looking."""

    def __init__(self) -> None:
        self.texts: dict[str, Understood | None] = {}
        self.depth = 0

    @property
    def enough(self) -> bool:
        return len(self.texts) >= MOST_TEXTS or self.depth >= DEEPEST


class Template:
    """A text with places, ``give {n} or more``, and what it is in another language."""

    def __init__(self, text: str, said: str):
        parts = PLACE.split(text)
        self.text, self.said, self._names, self._literals = text, said, parts[1::2], parts[::2]
        self.weight = sum(map(len, self._literals))
        self._short = sum(len(WORD.findall(literal)) for literal in self._literals) < 2

    def ways(self, sentence: str) -> Iterator[dict[str, str]]:
        """What may stand in the places of a sentence that is made of it. In those of a template that has one word of
        its own each is a word, lest it takes whatever has that word in it."""
        first, *between, last = self._literals
        if not sentence.startswith(first) or not sentence.endswith(last) or len(sentence) < self.weight:
            return
        inner = sentence[len(first):len(sentence) - len(last)]
        for values in islice(_cut(inner, between), MOST_WAYS):
            if not (self._short and any(" " in value for value in values)):
                yield dict(zip(self._names, values, strict=True))


def _cut(text: str, literals: list[str]) -> Iterator[list[str]]:
    """The text cut at literals that follow each other in it, wherever each is."""
    if not literals:
        yield [text]
        return
    first, *others = literals
    at = text.find(first)
    while at >= 0:
        for rest in _cut(text[at + len(first):], others):
            yield [text[:at], *rest]
        at = text.find(first, at + 1)


class Translator:
    """Puts sentences into one language; ``words`` are the texts that it knows, with what they are there."""

    def __init__(self, words: Mapping[str, str]):
        self._words = {text: said for text, said in words.items() if not PLACE.search(text)}
        self.templates = [Template(text, said) for text, said in words.items() if text not in self._words]
        self._beginnings = [text for text in self._words if text.endswith(" ") and not text.startswith(" ")]
        self._between = [text for text in self._words if text.endswith(" ") and text.startswith(" ")]
        self._endings = {PLACE.split(text)[0] for text in words if text.startswith(" ") and text not in self._between}

    def __call__(self, sentence: str) -> str:
        """The sentence, or itself where nobody knows it."""
        return self._part(sentence, Looked()).said

    def _part(self, text: str, looked: Looked) -> Understood:
        """What stands in a place: a name or a number stays as it is."""
        return self._known(text, looked) or Understood(0, text)

    def _known(self, text: str, looked: Looked) -> Understood | None:
        """A text that is known, or made of what is; None where it is not. What has been ``looked`` up is kept for the
        rest of its sentence."""
        if text not in looked.texts and not looked.enough:
            looked.texts[text] = None  # of itself it is not made
            looked.depth += 1
            looked.texts[text] = max(self._ways(text, looked), default=None, key=lambda way: way.known)
            looked.depth -= 1
        return looked.texts.get(text)

    def _ways(self, text: str, looked: Looked) -> Iterator[Understood]:
        if text in self._words:
            yield Understood(len(text), self._words[text])
            return
        for template in self.templates:
            for places in template.ways(text):
                parts = {name: self._part(value, looked) for name, value in places.items()}
                yield Understood(template.weight + sum(part.known for part in parts.values()),
                                 template.said.format(**{name: part.said for name, part in parts.items()}))
        for begun in self._beginnings:
            if text.startswith(begun):
                rest = self._part(text.removeprefix(begun), looked)
                yield Understood(len(begun) + rest.known, self._words[begun] + rest.said)
        for end in self._endings:
            if (at := text.rfind(end)) > 0 and (tail := self._known(text[at:], looked)):
                head = self._part(text[:at], looked)
                yield Understood(head.known + tail.known, head.said + tail.said)
        yield from self._joined(text, looked)

    def _joined(self, text: str, looked: Looked) -> Iterator[Understood]:
        """Two known texts side by side; before a colon the name of an input with its value, or of an estimator, will
        do."""
        for found in SEPARATORS.finditer(text):
            for begin, end in ((found.start(),) * 2, (found.end(),) * 2, found.span()):
                head, tail = self._known(text[:begin], looked), self._known(text[end:], looked)
                if head is None and text[begin:end] == ": ":
                    head = self._named(text[:begin])
                if head is not None and tail is not None:
                    yield Understood(head.known + tail.known, f"{head.said}{text[begin:end]}{tail.said}")
        for word in self._between:
            first, _, last = text.rpartition(word)
            before, after = (self._known(one, looked) or self._name(one) for one in (first, last))
            if first and before and after:
                yield Understood(before.known + after.known, f"{before.said}{self._words[word]}{after.said}")

    @staticmethod
    def _name(text: str) -> Understood | None:
        """A name, which is one word, stays as it is."""
        return None if " " in text else Understood(0, text)

    def _named(self, head: str) -> Understood | None:
        label = max((words for words in self._words if head.startswith(f"{words} ")), key=len, default=None)
        if label is not None:
            return Understood(len(label), self._words[label] + head.removeprefix(label))
        return self._name(head)


@functools.lru_cache
def translator(code: str) -> Translator:
    """That of a language."""
    return Translator(catalogue(code).of_files(PLACES))


def heard(sentence: str) -> str:
    """A sentence of the solvers in the language that is spoken; one that nobody knows stays English."""
    return sentence if language() == ENGLISH or not sentence or len(sentence) > LONGEST else _heard(sentence)


@kept(1024)
def _heard(sentence: str) -> str:
    return translator(language())(sentence)
