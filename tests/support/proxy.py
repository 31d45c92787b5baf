"""nginx before a lab, set up as ``assets/nginx.conf.example`` says, at the root and below a path."""

import os
import re
import shutil
import socket
import subprocess
from contextlib import contextmanager

import pytest

from solvers.workers.worker_process import free_port
from tests.support.paths import ASSETS
from tests.support.processes import HANG, wait_until

EXAMPLE = ASSETS / "nginx.conf.example"
NAME, CODE = "lab.school.example", "wave-4711"
HOW = "no {} found: install it (Debian: apt-get install nginx-light openssl) to run the tests of the proxy"
MAIN = """daemon off; pid {0}/pid; error_log {0}/errors; worker_processes 1;
events {{}}
http {{ access_log off; client_body_temp_path {0}/body; proxy_temp_path {0}/proxy; fastcgi_temp_path {0}/fastcgi;
uwsgi_temp_path {0}/uwsgi; scgi_temp_path {0}/scgi; include {0}/lab.conf; }}
"""


def found(program):
    path = shutil.which(program) or shutil.which(program, path="/usr/sbin")
    if path is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(HOW.format(program))
    return path


@contextmanager
def start_proxy(room, address):
    """nginx before the lab at this address, and once more below /lab/; its ports, for http and https. Its certificate
    is in the folder ``room``."""
    nginx, openssl = found("nginx"), found("openssl")
    subprocess.run([openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", f"/CN={NAME}",
                    "-addext", f"subjectAltName=DNS:{NAME}", "-keyout", room / "key", "-out", room / "certificate"],
                   check=True, capture_output=True, timeout=HANG)
    plain, secure, keys = free_port(), free_port(), f"/etc/letsencrypt/live/{NAME}"
    text = re.sub(r"^    #(?=location|    |})", "    ", EXAMPLE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    for old, new in [("listen 80;", f"listen 127.0.0.1:{plain};"), ("http://127.0.0.1:8080;", f"{address};"),
                     ("http://127.0.0.1:8080/;", f"{address}/;"),
                     ("listen 443 ssl;", f"listen 127.0.0.1:{secure} ssl;"),
                     (f"{keys}/fullchain.pem", str(room / "certificate")), (f"{keys}/privkey.pem", str(room / "key"))]:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (room / "lab.conf").write_text(text, encoding="utf-8")
    (room / "nginx.conf").write_text(MAIN.format(room), encoding="utf-8")
    process = subprocess.Popen([nginx, "-c", room / "nginx.conf", "-p", room, "-e", room / "errors"])
    try:
        wait_until(lambda: process.poll() is not None or listens(secure), "nginx listens")
        assert process.poll() is None, (room / "errors").read_text()
        yield plain, secure
    finally:
        process.terminate()
        process.wait(HANG)


def listens(port):
    with socket.socket() as trial:
        return trial.connect_ex(("127.0.0.1", port)) == 0
