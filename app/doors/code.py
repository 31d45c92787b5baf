"""The class code: who knows it gets a cookie, and with that the lab. Wrong guesses are counted."""

import hashlib
import hmac
import ipaddress
import math
import secrets
from collections import OrderedDict
from typing import NamedTuple

from app.doors.address import Headers
from app.doors.bucket import Bucket

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # none that is taken for another one on a board
MADE_UP, SHORTEST, LONGEST = 8, 6, 64  # letters; half of 31^8 codes, a guess in two seconds: 27,000 years
# Wrong guesses at once and a second: of one address, behind which a whole class may be, and of all.
ONE, ALL = (20, 1 / 6), (60, 1 / 2)
MOST_ADDRESSES = 1000  # remembered; a forgotten one may guess anew, but all together still not more than ``ALL``

WRONG = "This is not the code. Look at the board again, or ask your teacher."


class Entry(NamedTuple):
    """What came of a code: whether it ``opens``, and else why not and for how many seconds no other is looked at."""

    opens: bool
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
    """The code of one server, what wrong guesses there were, and the cookie for those who knew it."""

    def __init__(self, code: str, port: int):
        self._digest, self._token = _digest(plain(code)), secrets.token_urlsafe(32)
        self._name = f"mpm-lab-{port}"  # cookies do not know ports: two labs on a machine must not share one
        self._all, self._of = Bucket(*ALL), OrderedDict[str, Bucket]()

    @property
    def cookie(self) -> str:
        """The header that sets it, until the browser is closed or the server ends."""
        return f"{self._name}={self._token}; Path=/; HttpOnly; SameSite=Strict"

    def knows(self, headers: Headers) -> bool:
        """Whether a request brings the cookie."""
        pairs = (pair.partition("=") for line in headers.get_all("Cookie") for pair in line.split(";"))
        return any([hmac.compare_digest(_digest(value.strip()), _digest(self._token))
                    for name, _, value in pairs if name.strip() == self._name])

    def enter(self, guess: str, who: str) -> Entry:
        """Look at a code from an IP address; not while there were too many wrong ones, right or not."""
        who = network_of(who)
        own = self._of.get(who) or Bucket(*ONE)
        wait = math.ceil(max(own.wait(), self._all.wait()))
        if wait:
            return Entry(False, f"There were too many wrong codes. Wait {wait} s, then try again.", wait)
        if hmac.compare_digest(_digest(plain(guess)), self._digest):
            return Entry(True)
        own.pay()
        self._all.pay()
        self._of[who] = own
        self._of.move_to_end(who)
        while len(self._of) > MOST_ADDRESSES:
            self._of.popitem(last=False)
        return Entry(False, WRONG)


def _digest(text: str) -> bytes:
    """What is compared in constant time must be of one length, else the time tells that."""
    return hashlib.sha256(text.encode("utf-8", "replace")).digest()


def network_of(who: str) -> str:
    """Of an IPv6 address the part that its owner cannot change at will."""
    try:
        address = ipaddress.ip_address(who.partition("%")[0])
    except ValueError:
        return who
    return who if address.version == 4 else str(ipaddress.ip_network((address, 64), strict=False))
