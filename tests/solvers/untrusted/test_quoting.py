"""What is quoted from outside does nothing to a terminal, a page, a report or a spreadsheet, and is short."""

import html
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.lessons.markdown_html import to_html as rendered
from solvers.untrusted import quoting

texts = st.text(max_size=3000) | st.text(alphabet="\x1b[]m=\u202e\u2066\t\r\n!()<>`*_$&\\'\"|#x\udcff", max_size=80)
TARGETS = [quoting.quote, quoting.one_line, quoting.file_name, quoting.escape_markdown, quoting.code_span,
           quoting.escape_html]


@pytest.mark.parametrize("target", TARGETS)
@given(text=texts)
def test_nothing_that_does_not_show_is_left(target, text):
    said = target(text)
    assert said.isprintable()
    said.encode()  # half a surrogate could not be written


@given(texts)
def test_what_is_long_is_cut_with_an_ellipsis(text):
    for target, most in ((quoting.quote, quoting.QUOTE), (quoting.one_line, quoting.SENTENCE),
                         (quoting.file_name, quoting.NAME)):
        said = target(text)
        assert len(said) <= most
        assert quoting.ELLIPSIS in said or len(text) <= most or text.isspace() or target is quoting.file_name \
            or len(" ".join(text.split())) <= most


@pytest.mark.parametrize("value, said", [
    ("\x1b[31mred", "\\x1b[31mred"), ("a\u202eb", "a\\u202eb"), ("", "(no value)"), (" \n", "(no value)"),
    ("n" * 100 + ".csv", "n" * 30 + "…" + "n" * 25 + ".csv"), (0.1, "0.1"), (12, "12"), ("naïve Ω", "naïve Ω")])
def test_a_value_within_a_sentence(value, said):
    assert quoting.quote(value) == said


def test_a_number_that_python_would_not_write_is_named():
    assert quoting.quote(10**5000) == "a number of more than 1,000 digits"


@given(st.text(alphabet="![](){}<>*_`$#~&;ab: /\\|", max_size=40))
def test_in_markdown_a_text_means_nothing_but_itself(text):
    """No picture, link, emphasis, formula or html comes of it: a paragraph with that text."""
    page = rendered(f"* x{quoting.escape_markdown(text)}x\n* y {quoting.code_span(text)} y")
    assert set(re.findall(r"</?(\w+)", page)) <= {"ul", "li", "code"}
    first = page.partition("<li>")[2].partition("</li>")[0]
    assert html.unescape(first) == f"x{' '.join(text.split())}x"


@pytest.mark.parametrize("value, cell", [
    ("=1+1", "'=1+1"), ("+cmd|'/C calc'!A0", "'+cmd|'/C calc'!A0"), ("-2+3", "'-2+3"), ("@SUM(A1)", "'@SUM(A1)"),
    ("\t=1", "\\t'=1"), ("\r=1", "\\r'=1"), ("  =1", "'  =1"), ("＝1", "'＝1"),
    ("-2.5", "-2.5"), ("+3e-4", "+3e-4"), (-2.5, -2.5), (None, None), ("plain", "plain"), ("a\nb", "a\\nb"),
    ("x;=1", "x;'=1"), ("x, -y", "x,' -y"), ("x\t@y", "x\\t'@y"), ("x;-1, 2", "x;-1, 2"), ("-1 2 3", "-1 2 3"),
    ("-1 mm", "'-1 mm")])
def test_a_cell_is_no_formula_and_a_number_stays_one(value, cell):
    assert quoting.csv_cell(value) == cell
    assert quoting.csv_text([[value]]) == (f"{value}\n" if type(value) is float else f'"{cell or ""}"\n')


@pytest.mark.parametrize("word, said", [("ugipm", " (did you mean ugimp?)"), ("zzz", ""), ("x" * 10**6, "")])
def test_what_is_known_near_a_word(word, said):
    assert quoting.suggest_word(word, ["ugimp", "mpm"]) == said
