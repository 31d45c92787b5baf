"""The page in another language: a link to each that there is, in its own words. ``js/languages.js`` has it keep what is
seen."""

from app.language.spoken import LANGUAGES, language


def links() -> str:
    """Html of the links to all languages but the one that is spoken."""
    return " ".join(f"<a class='lab-language' href='?lang={code}' lang='{code}' hreflang='{code}'>{other.name}</a>"
                    for code, other in LANGUAGES.items() if code != language())
