"""The class code: who knows it gets a cookie, and with that the lab; the teacher's own opens the notes, too, and that
of the board, the board. A cookie is one browser's: it has a key, made up and proven, that says nothing of who that is.

A right code opens whatever others do. So wrong ones are counted, by network and in all, for what is said of them alone:
who guesses on is told to wait, and learns nothing else. What keeps a code from being found is that there are too many.
"""

import hashlib
import hmac
import math
import secrets
from functools import partial
from typing import NamedTuple

from app.access.allowed_hosts import Headers
from app.access.network_limits import TokenBucket, TokenBuckets, network_of
from app.language.translation import lazy, tr

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # none that is taken for another one on a board
MADE_UP, SHORTEST, LONGEST = 8, 6, 64  # letters; half of 31^8 codes, a thousand a second: 13 years
# Wrong guesses at once and a second: of one network, behind which a whole class may be, and of all.
ONE, ALL = (20, 1 / 6), (60, 1 / 2)

CLASS, TEACHER, BOARD = "class", "teacher", "board"  # whose codes there are

WRONG = lazy("This is not the code. Look at the board again, or ask your teacher.")


class LoginResult(NamedTuple):
    """The ``cookie`` that a code gives, perhaps for ``more`` than the lab; else why not, and when to try again (s)."""

    cookie: str = ""
    more: bool = False
    sentence: str = ""
    wait: int = 0


class AccessIdentity(NamedTuple):
    """Who brings a cookie: with ``whose`` code he has come, and the ``key`` that all pages of his browser have."""

    whose: str
    key: str = ""


def generate_code() -> str:
    """A code that nobody can guess, in two halves to read it by."""
    code = "".join(secrets.choice(LETTERS) for _ in range(MADE_UP))
    return f"{code[:MADE_UP // 2]}-{code[MADE_UP // 2:]}"


def normalise_code(code: str) -> str:
    """A code as it counts: small and large letters, spaces and dashes make no difference."""
    return "".join(code.casefold().replace("-", "").split())


class ClassCode:
    """The code of a server, those of its ``teacher`` and ``board``, its cookies, and a count of wrong guesses."""

    def __init__(self, code: str, port: int, teacher: str = "", board: str = ""):
        self._name = f"mpm-lab-{port}"  # cookies do not know ports: two labs on a machine must not share one
        codes = {CLASS: code, TEACHER: teacher, BOARD: board}
        self._secrets = {whose: secrets.token_bytes(32) for whose, key in codes.items() if key}
        self._codes = {whose: _digest(normalise_code(codes[whose])) for whose in self._secrets}
        self._all, self._of = TokenBucket(*ALL), TokenBuckets(partial(TokenBucket, *ONE))

    def knows(self, headers: Headers) -> bool:
        """Whether a request brings a cookie of this server."""
        return self.guest(headers) is not None

    def guest(self, headers: Headers) -> AccessIdentity | None:
        """Who asks, by the cookie that opens most; all are looked at, so that the time tells nothing."""
        pairs = (pair.partition("=") for line in headers.get_all("Cookie") for pair in line.split(";"))
        brought = [value.strip().partition(".") for name, _, value in pairs if name.strip() == self._name]
        found = [AccessIdentity(whose, key) for whose in self._secrets for key, _, proof in brought
                 if hmac.compare_digest(_digest(self._proof(whose, key)), _digest(proof))]
        return found[-1] if found else None

    def enter(self, guess: str, who: str) -> LoginResult:
        """Look at a code from an IP address."""
        digest = _digest(normalise_code(guess))
        opened = [whose for whose, code in self._codes.items() if hmac.compare_digest(digest, code)]
        if opened:
            key, whose = secrets.token_urlsafe(16), opened[-1]  # good until the browser is closed or the server ends
            return LoginResult(f"{self._name}={key}.{self._proof(whose, key)}; Path=/; HttpOnly; SameSite=Strict",
                         more=whose != CLASS)
        own = self._of.of(network_of(who))
        wait = math.ceil(max(own.wait(), self._all.wait()))
        if wait:
            told = tr("There were too many wrong codes. Wait {wait} s, then try again.", wait=wait)
            return LoginResult(sentence=told, wait=wait)
        own.pay()
        self._all.pay()
        return LoginResult(sentence=tr(WRONG))

    def _proof(self, whose: str, key: str) -> str:
        """That a key is of this server's making."""
        return hmac.new(self._secrets[whose], key.encode("utf-8", "replace"), hashlib.sha256).hexdigest()


def _digest(text: str) -> bytes:
    """What is compared in constant time must be of one length, else the time tells that."""
    return hashlib.sha256(text.encode("utf-8", "replace")).digest()
