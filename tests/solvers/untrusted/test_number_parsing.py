"""Numbers are read in one way, wherever they are typed."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.commands.lenient_flag_types import BadInput, parse_float_or_text, parse_number_or_text, parse_times
from app.names_and_units import parse_size
from app.page.features.cost.cost_texts import InvalidNumber, parse_positive
from app.shareable_state import StateError
from app.shareable_state import parse_state as read_state
from solvers.untrusted import number_parsing

NONE = ["", " ", "4_0", "４０", "٣", "0x10", "inf", "-inf", "nan", "Infinity", "1e400", "9" * 10_000, "1e", "e5", ".",
        "1,5", "--1", "1 2", "²", "1e1_0", "\x1b[31m1", "True", "None"]


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_number_is_none_anywhere(text):
    assert not number_parsing.is_number(text)
    assert (
        parse_number_or_text([text]) == text and parse_float_or_text([text]) == text
    )  # flags, of which the scene says what is wrong
    for read, refusal in ((lambda: parse_times((text,), "time"), BadInput),
                          (lambda: parse_positive("Tolerance", text), InvalidNumber),
                          (lambda: read_state("bar;cells=" + text.replace(" ", "_")), StateError),
                          (lambda: parse_size(text.replace(",", " "), "m"), ValueError)):
        with pytest.raises(refusal):
            read()


@given(st.floats(allow_nan=False, allow_infinity=False, allow_subnormal=False) | st.integers(-10**15, 10**15))
def test_every_number_comes_back_to_the_bit(value):
    """But those that are not normal, which a process in which Taichi has run takes for 0."""
    assert number_parsing.parse_number(repr(value)) == value
    back = number_parsing.parse_float(repr(value))
    assert back == value and math.copysign(1, back) == math.copysign(1, value)


@pytest.mark.parametrize("text, value", [("1e3", 1000), ("40", 40), (" 40 ", 40), ("+7", 7), ("1e-3", 1e-3),
                                         (".5", 0.5), ("5.", 5.0), ("1E2", 100), ("1e16", 1e16)])
def test_a_whole_number_is_one_with_an_exponent_too(text, value):
    found = number_parsing.parse_number(text)
    assert found == value and type(found) is type(value)


def test_a_count_is_digits_and_nothing_else():
    assert [number_parsing.parse_count(text) for text in ("0", "17", "-1", "1.0", "１", "1" * 10,
                                                          "")] == [0, 17, *[None] * 5]
