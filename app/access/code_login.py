"""The class code: it gives a cookie that admits to the lab; the teacher's code also opens the notes, the board's code
the board. A cookie belongs to one browser: it has a random, signed key that does not reveal who that is.

A right code always works. Wrong ones are counted, by network and in all, only to answer with a waiting time."""

import hashlib
import hmac
import math
import secrets
import unicodedata
from functools import partial
from typing import NamedTuple

from app.access.allowed_hosts import Headers
from app.access.network_limits import TokenBucket, TokenBuckets, network_of
from app.language.translation import lazy, tr

PLAIN_QUOTES = str.maketrans("\u2018\u2019\u201a\u201c\u201d\u201e", "'''\"\"\"")
LEFT_OUT = ("Pd", "Zs", "Zl", "Zp", "Cc", "Cf")  # categories of Unicode
LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # no letters that look alike on a board
MADE_UP, SHORTEST, LONGEST = 8, 6, 64  # letters; half of 31^8 codes, a thousand a second: 13 years
# Burst and rate per second of wrong guesses: of one network, which may be a whole class, and of all.
ONE, ALL = (20, 1 / 6), (60, 1 / 2)

CLASS, TEACHER, BOARD = "class", "teacher", "board"  # owners of codes

WRONG = lazy("This is not the code. Look at the board again, or ask your teacher.")


class LoginResult(NamedTuple):
    """The ``cookie``, a Set-Cookie header, that a right code gives, and whether it is for ``more`` than the lab (notes,
    board); for a wrong code the ``refusal``, a sentence, and the seconds to ``wait`` before the next guess."""

    cookie: str = ""
    more: bool = False
    refusal: str = ""
    wait: int = 0


class CookieIdentity(NamedTuple):
    """Identity in a cookie: ``role`` of the code used ("class", "teacher", "board"), random ``key`` of the browser."""

    role: str
    key: str = ""


def generate_code() -> str:
    """Returns a random class code, in two halves for readability: "abcd-efgh"."""
    code = "".join(secrets.choice(LETTERS) for _ in range(MADE_UP))
    return f"{code[:MADE_UP // 2]}-{code[MADE_UP // 2:]}"


def normalise_code(code: str) -> str:
    """Returns a code for comparisons: in lower case, without spaces, dashes and what does not show, and with plain
    quotes and ordinary letters for typographic and wide ones, as keyboards change them."""
    plain = unicodedata.normalize("NFKC", code.translate(PLAIN_QUOTES)).casefold()
    return "".join(letter for letter in plain if unicodedata.category(letter) not in LEFT_OUT)


class CodeLogin:
    """Codes of the server at ``port``, for the class, ``teacher`` and ``board`` ("": none); cookies, wrong guesses."""

    def __init__(self, code: str, port: int, teacher: str = "", board: str = ""):
        self._name = f"mpm-lab-{port}"  # cookies ignore ports: two labs on a machine must not share one
        codes = {CLASS: code, TEACHER: teacher, BOARD: board}
        self._secrets = {whose: secrets.token_bytes(32) for whose, key in codes.items() if key}
        self._codes = {whose: _digest(normalise_code(codes[whose])) for whose in self._secrets}
        self._all, self._of = TokenBucket(*ALL), TokenBuckets(partial(TokenBucket, *ONE))

    def is_authorised(self, headers: Headers) -> bool:
        """Whether a request has a valid cookie of this server."""
        return self.identify(headers) is not None

    def identify(self, headers: Headers) -> CookieIdentity | None:
        """Returns the identity with most rights in a request's valid cookies, or None; checks all, in constant time."""
        pairs = (pair.partition("=") for line in headers.get_all("Cookie") for pair in line.split(";"))
        brought = [value.strip().partition(".") for name, _, value in pairs if name.strip() == self._name]
        found = [CookieIdentity(whose, key) for whose in self._secrets for key, _, proof in brought
                 if hmac.compare_digest(_digest(self._signature(whose, key)), _digest(proof))]
        return found[-1] if found else None

    def log_in(self, guess: str, address: str) -> LoginResult:
        """Checks a code typed at an IP address; a wrong one is counted, for the address's network and in all."""
        digest = _digest(normalise_code(guess))
        opened = [whose for whose, code in self._codes.items() if hmac.compare_digest(digest, code)]
        if opened:
            key, whose = secrets.token_urlsafe(16), opened[-1]  # valid until the browser closes or the server ends
            return LoginResult(f"{self._name}={key}.{self._signature(whose, key)}; Path=/; HttpOnly; SameSite=Strict",
                               more=whose != CLASS)
        own = self._of.get(network_of(address))
        wait = math.ceil(max(own.delay(), self._all.delay()))
        if wait:
            told = tr("There were too many wrong codes. Wait {wait} s, then try again.", wait=wait)
            return LoginResult(refusal=told, wait=wait)
        own.debit()
        self._all.debit()
        return LoginResult(refusal=tr(WRONG))

    def _signature(self, role: str, key: str) -> str:
        """Returns the signature of a browser's key in a cookie for this role, in hexadecimal digits."""
        return hmac.new(self._secrets[role], key.encode("utf-8", "replace"), hashlib.sha256).hexdigest()


def _digest(text: str) -> bytes:
    """Returns the SHA-256 digest of a text, as comparisons in constant time need equal lengths."""
    return hashlib.sha256(text.encode("utf-8", "replace")).digest()
