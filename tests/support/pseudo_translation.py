"""A language by which one sees what no other can have other words for: every text of the code stands between ⟦ and ⟧;
what does not has not been asked for by ``tr``. Named in ``MPM_LAB_EXTENSIONS``, it is ``?lang=xx``."""

import tempfile
from pathlib import Path

from babel.messages.pofile import write_po

from app.language.translation import LANGUAGES, Language
from tests.words import template

CODE = "xx"


def write_catalogue(file: Path) -> Path:
    """The file of that language's words."""
    words = template()
    for entry in words:
        if entry.id:
            both = entry.id if isinstance(entry.id, tuple) else (entry.id,)
            said = tuple(f"⟦{text}⟧" for text in both)
            entry.string = said if isinstance(entry.id, tuple) else said[0]
    with file.open("wb") as out:
        write_po(out, words, include_lineno=False)
    return file


LANGUAGES[CODE] = Language("Pseudo", write_catalogue(Path(tempfile.mkdtemp()) / "xx.po"))
