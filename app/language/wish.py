"""Which language a browser wants: the one that its address names, else the first of its own that there is."""

from urllib.parse import parse_qs

from app.language.spoken import ENGLISH, LANGUAGES

COOKIE = "mpm-lab-language"
LONGEST = 1000  # characters of a wish that are read


def wished(query: str, accepted: str) -> str:
    """The language of a page: of the ``query`` of its address (``lang=de``), else of the header Accept-Language."""
    asked = parse_qs(query[:LONGEST]).get("lang", [""])[-1].lower()
    if asked in LANGUAGES:
        return asked
    return next((code for code in _by_liking(accepted) if code in LANGUAGES), ENGLISH)


def _by_liking(accepted: str) -> list[str]:
    """The languages of a header such as ``de-CH, en;q=0.7``, the most wanted first, without their countries."""
    liked = []
    for place, part in enumerate(accepted[:LONGEST].split(",")):
        name, _, quality = part.strip().lower().partition(";q=")
        try:
            much = float(quality or 1)
        except ValueError:
            continue
        if much > 0:
            liked.append((-much, place, name.partition("-")[0]))
    return [name for _, _, name in sorted(liked)]


def as_cookie(code: str) -> str:
    """The header by which a browser tells its websocket, whose address is not the page's, what the page speaks."""
    return f"{COOKIE}={code}; Path=/; HttpOnly; SameSite=Strict"


def of_cookie(cookies: list[str]) -> str:
    """The language that the cookies of a request name."""
    pairs = (pair.strip().partition("=") for line in cookies for pair in line.split(";"))
    named = next((value for name, _, value in pairs if name == COOKIE), ENGLISH)
    return named if named in LANGUAGES else ENGLISH
