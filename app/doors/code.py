"""The class code: who knows it gets a cookie, and with that the lab; the teacher's own opens the notes, too.

A right code opens whatever others do. So wrong ones are counted, by network and in all, for what is said of them alone:
who guesses on is told to wait, and learns nothing else. What keeps a code from being found is that there are too many.
"""

import hashlib
import hmac
import math
import secrets
from functools import partial
from typing import NamedTuple

from app.doors.address import Headers
from app.doors.bucket import Bucket
from app.doors.network import Buckets, network_of
from app.language.spoken import later, tr

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # none that is taken for another one on a board
MADE_UP, SHORTEST, LONGEST = 8, 6, 64  # letters; half of 31^8 codes, a thousand a second: 13 years
# Wrong guesses at once and a second: of one network, behind which a whole class may be, and of all.
ONE, ALL = (20, 1 / 6), (60, 1 / 2)

WRONG = later("This is not the code. Look at the board again, or ask your teacher.")


class Entry(NamedTuple):
    """What came of a code: the ``cookie`` that opens, perhaps the notes, too; else why not, and in how many seconds to
    try again."""

    cookie: str = ""
    teaches: bool = False
    sentence: str = ""
    wait: int = 0


def made_up() -> str:
    """A code that nobody can guess, in two halves to read it by."""
    code = "".join(secrets.choice(LETTERS) for _ in range(MADE_UP))
    return f"{code[:MADE_UP // 2]}-{code[MADE_UP // 2:]}"


def plain(code: str) -> str:
    """A code as it counts: small and large letters, spaces and dashes make no difference."""
    return "".join(code.casefold().replace("-", "").split())


class ClassCode:
    """The code of one server and that of its ``teacher``, if there is one; what wrong guesses there were, and the
    cookies for those who knew one."""

    def __init__(self, code: str, port: int, teacher: str = ""):
        self._name = f"mpm-lab-{port}"  # cookies do not know ports: two labs on a machine must not share one
        self._keys = [(_digest(plain(key)), secrets.token_urlsafe(32)) for key in (code, teacher) if key]
        self._has_teacher = bool(teacher)
        self._all, self._of = Bucket(*ALL), Buckets(partial(Bucket, *ONE))

    def knows(self, headers: Headers) -> bool:
        """Whether a request brings a cookie of this server."""
        return any(self._brought(headers))

    def teaches(self, headers: Headers) -> bool:
        """Whether it brings the teacher's."""
        return self._has_teacher and self._brought(headers)[-1]

    def enter(self, guess: str, who: str) -> Entry:
        """Look at a code from an IP address."""
        digest = _digest(plain(guess))
        opened = [token for key, token in self._keys if hmac.compare_digest(digest, key)]
        if opened:
            return Entry(self._cookie(opened[-1]), teaches=self._has_teacher and opened[-1] == self._keys[-1][1])
        own = self._of.of(network_of(who))
        wait = math.ceil(max(own.wait(), self._all.wait()))
        if wait:
            told = tr("There were too many wrong codes. Wait {wait} s, then try again.", wait=wait)
            return Entry(sentence=told, wait=wait)
        own.pay()
        self._all.pay()
        return Entry(sentence=tr(WRONG))

    def _cookie(self, token: str) -> str:
        """The header that sets it, until the browser is closed or the server ends."""
        return f"{self._name}={token}; Path=/; HttpOnly; SameSite=Strict"

    def _brought(self, headers: Headers) -> list[bool]:
        """Of each key whether its cookie is brought; all are looked at, so that the time tells nothing."""
        pairs = (pair.partition("=") for line in headers.get_all("Cookie") for pair in line.split(";"))
        brought = [_digest(value.strip()) for name, _, value in pairs if name.strip() == self._name]
        return [any([hmac.compare_digest(digest, _digest(token)) for digest in brought]) for _, token in self._keys]


def _digest(text: str) -> bytes:
    """What is compared in constant time must be of one length, else the time tells that."""
    return hashlib.sha256(text.encode("utf-8", "replace")).digest()
