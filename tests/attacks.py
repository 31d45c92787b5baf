"""A process that does a lab harm, or tries to, until it is ended: ``python -m tests.attacks ADDRESS KIND``."""

from __future__ import annotations

import logging
import os
import socket
import sys
from contextlib import suppress
from itertools import count
from time import monotonic, sleep

import msgspec
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from tests.raw import Raw, unknown

A_SECOND = 1000  # messages
LARGE, HUGE = 900_000, 49_000_000  # bytes


def _steadily(act):
    """Do something ``A_SECOND`` times a second; what was missed meanwhile is not made up for."""
    due = monotonic()
    while True:
        due = max(due + 1 / A_SECOND, monotonic() - 0.05)
        act()
        sleep(max(0.0, due - monotonic()))


def _updates(raw, updates):
    """Send values of the slider of cells, one after the other."""
    slider = raw.find("Cells, h = 1/40")
    values = iter([])

    def one():
        nonlocal values
        value = next(values, None)
        if value is None:
            values = iter(updates)
            value = next(values)
        raw.set(slider, value)

    _steadily(one)


ATTACKS = {
    "garbage": lambda raw: _steadily(lambda: raw.say(os.urandom(200))),
    "nested": lambda raw: _steadily(lambda: raw.say(b"\x91" * 30_000)),
    "unknown ids": lambda raw: _steadily(lambda: raw.set(unknown(), 1)),
    "tunnels": lambda raw: _steadily(lambda: raw.say({"type": "ShareUrlRequest"})),
    "100,000 cells": lambda raw: _updates(raw, [100_000.0, -5.0, 1e9]),
    "1,000 good values": lambda raw: _updates(raw, [39.0, 40.0, 41.0, 42.0]),
    "large messages": lambda raw: _steadily(lambda: raw.say(msgspec.msgpack.encode({"type": "x" * LARGE}))),
    "49 MB": lambda raw: _steadily(lambda: raw.say(b"\x00" * HUGE))}


def _knock(address):
    """Open websockets of another site's page, and speak no HTTP."""
    def one():
        with suppress(OSError, InvalidHandshake):
            Raw(address, {"Origin": "http://evil.example"}, arrive=False).close()
        host, port = address.removeprefix("http://").split(":")
        with suppress(OSError), socket.create_connection((host, int(port)), timeout=5) as line:
            line.sendall(b"\x16\x03\x01 no HTTP\r\n\r\n")

    while True:
        one()
        sleep(0.01)


def main(address, kind):
    """Come again at once whenever one is sent away, from another address of this machine (all of 127.0.0.0/8 is)."""
    logging.getLogger("websockets.client").disabled = True
    if kind == "knocking":
        _knock(address)
    for come in count(256):
        with suppress(OSError, InvalidHandshake, ConnectionClosed):
            raw = Raw(address, source_address=(f"127.0.{come // 250 % 250}.{come % 250 + 1}", 0))
            try:
                ATTACKS[kind](raw)
            finally:
                raw.close()
        sleep(0.1)


if __name__ == "__main__":
    main(*sys.argv[1:])
