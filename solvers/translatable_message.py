"""Sentences for people that keep their template and values, so that they can be translated."""

import re
from collections.abc import Iterable
from string import Formatter
from typing import Any, SupportsIndex

PLACE = re.compile(r"\{((?:\w+\.)*(\w+))(?::([^{}]*))?\}")  # whole, its last name, and the format
FORMATTER = Formatter()


class Message(str):
    """An English sentence, or a part of one, with the ``template`` and the ``values`` that it is made of.

    The template has places as those of :meth:`str.format`, ``give {least:,} or more``, for values in their order or by
    their names. The attribute ``template`` has the last names of the places alone, ``{ppc}`` for ``{scene.ppc:g}``,
    and ``values`` has the texts in them, of which some are messages. Without values the template is the sentence.
    """

    template: str
    values: dict[str, str]

    def __new__(cls, template: str, /, *values: object, **named: object) -> "Message":
        if isinstance(template, Message) and (template.values or not (values or named)):
            return template  # it has all its values
        text, parts = str(template), dict[str, str]()
        if values or named:
            places = PLACE.findall(text)
            named = named or dict(zip(dict.fromkeys(name for _, name, _ in places), values, strict=True))
            for place, name, form in places:
                value = named[place] if place in named else FORMATTER.get_field(place, (), named)[0]
                parts[name] = value if isinstance(value, str) and not form else format(value, form)
            text = PLACE.sub(r"{\2}", text)
        message = super().__new__(cls, text.format(**parts) if parts else text)
        message.template, message.values = text, parts
        return message

    def __str__(self) -> str:
        return self

    def __add__(self, other: str) -> str:
        return Message("{head}{rest}", self, other) if other else self

    def __radd__(self, other: str) -> str:
        return Message("{head}{rest}", other, self) if other else self

    def __mul__(self, times: SupportsIndex) -> str:
        return self if times.__index__() == 1 else str.__mul__(self, times)

    def __getnewargs_ex__(self) -> tuple[tuple[str], dict[str, str]]:
        return (self.template,), self.values


def join_messages(joint: str, parts: Iterable[str]) -> str:
    """Returns the parts with ``joint`` between them, still translatable, as :meth:`str.join` does; "" without parts."""
    text, *others = tuple(parts) or ("",)
    for part in others:
        text = Message("{text}{joint}{part}", text, Message(joint), part)
    return text


def messages_to_json(value: Any) -> Any:
    """Returns a nested value for :func:`json.dumps`: each message is an object of its ``template`` and ``values``."""
    if isinstance(value, Message):
        return {"template": value.template, "values": messages_to_json(value.values)}
    if isinstance(value, dict):
        return {key: messages_to_json(one) for key, one in value.items()}
    return [messages_to_json(one) for one in value] if isinstance(value, (list, tuple)) else value


def message_from_json(decoded: dict[str, Any]) -> Any:
    """Returns the message of such an object by :func:`messages_to_json`, others as they are: a ``json`` object_hook."""
    return Message(decoded["template"], **decoded["values"]) if decoded.keys() == {"template", "values"} else decoded
