"""Translation of finished English sentences from the solvers, often from another process, and of rejected links. The
matching template of the catalogue is found by its words, and the texts in its placeholders are translated in the same
way. If several templates match, the one with the most literal letters wins."""

import functools
import re
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import NamedTuple

from app.language.translation import ENGLISH, current_language, language_cache, load_catalogue

PLACES = ("solvers/", "app/state.py")  # sources of such sentences
LONGEST = 1000  # characters of a sentence
MOST_WAYS = 30  # matches per template that are tried
MOST_TEXTS = 500  # lookups per sentence: one with quoted input may need any number
DEEPEST = 20  # nested templates
JOINTS = ("; ", ": ", ", ", " (")  # separators of the parts of a sentence outside of templates
PLACE, WORD = re.compile(r"\{(\w+)\}"), re.compile(r"[^\W\d_]{2,}")


class TranslationMatch(NamedTuple):
    """Translated text, and how many of its letters were ``known``."""

    known: int
    said: str


class Template:
    """Text with places, ``give {n} or more``, and its translation; ``strict`` places match known text or one word."""

    def __init__(self, text: str, said: str, strict: bool = False):
        parts = PLACE.split(text)
        self.said, self.strict, self._names, self._literals = said, strict, parts[1::2], parts[::2]
        self.weight = sum(map(len, self._literals))
        #: A template with at most one word takes single words only, as it would otherwise match too much.
        self._short = not strict and sum(len(WORD.findall(literal)) for literal in self._literals) < 2

    def ways(self, sentence: str) -> Iterator[dict[str, str]]:
        """Yields the texts of the placeholders for each match of a sentence."""
        first, *between, last = self._literals
        if not sentence.startswith(first) or not sentence.endswith(last) or len(sentence) < self.weight:
            return
        inner = sentence[len(first):len(sentence) - len(last)]
        for values in islice(_cut(inner, between), MOST_WAYS):
            if not (self._short and any(" " in value for value in values)):
                yield dict(zip(self._names, values, strict=True))


def _cut(text: str, literals: list[str]) -> Iterator[list[str]]:
    """Yields the text split at literals that follow each other in it, at every possible position."""
    if not literals:
        yield [text]
        return
    first, *others = literals
    for found in re.finditer(re.escape(first), text):
        for rest in _cut(text[found.end():], others):
            yield [text[:found.start()], *rest]


class Translator:
    """Translator into one language; ``words`` are the known texts with their translations."""

    def __init__(self, words: Mapping[str, str]):
        self._words = {text: said for text, said in words.items() if not PLACE.search(text)}
        self._templates = [Template(text, said) for text, said in words.items() if text not in self._words]
        for text, said in words.items():  # some are parts of others
            if text.startswith(" ") and text.endswith(" "):
                self._templates.append(Template(f"{{a}}{text}{{b}}", f"{{a}}{said}{{b}}", strict=True))
            elif text.endswith(" "):
                self._templates.append(Template(f"{text}{{rest}}", f"{said}{{rest}}"))
            elif text[0] in " ;,":
                self._templates.append(Template(f"{{head}}{text}", f"{{head}}{said}"))

    def __call__(self, sentence: str) -> str:
        """Returns the translation, or the sentence itself if it is not known."""
        found = self._known(sentence, {}, 0)
        return found.said if found else sentence

    def _known(self, text: str, looked: dict[str, TranslationMatch | None], depth: int) -> TranslationMatch | None:
        """Translates a text that is known or made of known parts, else None; ``looked`` caches a sentence."""
        if text not in looked and len(looked) < MOST_TEXTS and depth < DEEPEST:
            looked[text] = None  # not part of itself
            looked[text] = max(self._ways(text, looked, depth + 1), default=None, key=lambda way: way.known)
        return looked.get(text)

    def _ways(self, text: str, looked: dict[str, TranslationMatch | None], depth: int) -> Iterator[TranslationMatch]:
        if text in self._words:
            yield TranslationMatch(len(text), self._words[text])
            return
        for template in self._templates:
            for places in template.ways(text):
                known = {name: self._known(value, looked, depth) for name, value in places.items()}
                if not (template.strict and any(known[name] is None and " " in places[name] for name in places)):
                    parts = {name: part or TranslationMatch(0, places[name]) for name, part in known.items()}
                    yield TranslationMatch(template.weight + sum(part.known for part in parts.values()),
                                     template.said.format(**{name: part.said for name, part in parts.items()}))
        for joint in JOINTS:
            for found in re.finditer(re.escape(joint), text):
                before, after = text[:found.start()], text[found.end():]
                head, tail = self._known(before, looked, depth), self._known(after, looked, depth)
                if head is None and joint == ": ":
                    # The name of an input with its value, or of an estimator before a colon.
                    label = max((words for words in self._words if before.startswith(f"{words} ")),
                                key=len, default=None)
                    if label is not None:
                        head = TranslationMatch(len(label), self._words[label] + before.removeprefix(label))
                    elif " " not in before:
                        head = TranslationMatch(0, before)
                if head is not None and tail is not None:
                    yield TranslationMatch(head.known + tail.known, f"{head.said}{joint}{tail.said}")


@functools.lru_cache
def translator_for(code: str) -> Translator:
    """Returns the translator of a language."""
    return Translator(load_catalogue(code).of_files(PLACES))


def translate_message(sentence: str) -> str:
    """Translates a sentence of the solvers into the current language; an unknown one stays English."""
    return sentence if current_language() == ENGLISH or not sentence or len(sentence) > LONGEST else _heard(sentence)


@language_cache(1024)
def _heard(sentence: str) -> str:
    return translator_for(current_language())(sentence)
