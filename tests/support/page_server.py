"""A lab without engines, whose doors are real: what tests of them share."""

import socket
from contextlib import contextmanager

from app.access.allowed_hosts import Addresses
from app.access.code_login import BOARD, CLASS, TEACHER
from app.classroom.class_context import LessonContext
from app.page.listening_address import THIS_MACHINE, authority
from app.page.page_server import _start_server
from solvers.study.landscape.error_history import HistoryCache
from solvers.workers.worker_process import free_port


class SilentLink:
    """A line to no engine: who asks gets a number and never a frame."""

    number = 0

    def ask(self, *_, **__):
        self.number += 1
        return self.number

    def survey(self, *_):
        """Nothing is computed."""

    def close(self):
        """There is nothing to close."""


class SilentPool:
    histories = HistoryCache()
    playing_sessions = 0
    process_ids = ()

    def set_delivery_context(self, together):
        pass

    def wait_ready(self, timeout):
        return True

    def open_session(self, listener, beside=None):
        return SilentLink()


@contextmanager
def start_server(host="127.0.0.1", names=(), code="", notes="", classroom=None, board=None, board_code=""):
    """The page's own web server in this process, without engines; and its address."""
    port = free_port()
    codes = {CLASS: code, TEACHER: notes, BOARD: board_code}
    one = _start_server(host, port, SilentPool(), 4, Addresses(host, names), codes, classroom or LessonContext(),
                        board)
    try:
        yield one, f"http://{authority(THIS_MACHINE.get(host, host), port)}"
    finally:
        one.stop()


def http_get(address, path="/", headers=()):
    """Status and body of an answer to exactly these headers, and a Host unless they have one; "" sends none."""
    host, _, port = address.removeprefix("http://").rpartition(":")
    headers = {"Host": f"{host}:{port}", **dict(headers)}
    lines = [f"GET {path} HTTP/1.1", *(f"{name}: {value}" for name, value in headers.items() if value), "", ""]
    with socket.create_connection((host.strip("[]"), int(port)), timeout=20) as line:
        line.sendall("\r\n".join(lines).encode("latin1"))
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += (more := line.recv(65536))
            assert more
        head, _, body = answer.partition(b"\r\n\r\n")
        status = int(head.split()[1])
        while status != 101 and (more := line.recv(65536)):
            body += more
    http_get.head = head.decode()
    return status, body
