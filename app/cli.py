"""Entry point of the command line ``mpm-lab``, light enough that Ctrl-C is one line even while the rest loads."""

import os
import sys

BAD_INPUT, INTERRUPTED = 2, 130


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line (by default the process's arguments) and returns its exit status."""
    _fill_closed_streams()
    try:
        from solvers.scene.extension_modules import ExtensionError
        try:
            from app.commands.dispatch import dispatch
        except ExtensionError as error:  # extensions are loaded before the commands
            print(f"mpm-lab: {error}", file=sys.stderr, flush=True)
            return BAD_INPUT
        return dispatch(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:
        print("mpm-lab: interrupted", file=sys.stderr, flush=True)
        return INTERRUPTED


def _fill_closed_streams() -> None:
    """Opens closed standard streams (``>&-``) on the null device, as the next opened file would take their numbers."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)  # the processes that this one starts need it too
    os.close(number)
    for name, descriptor in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            stream = open(descriptor, "w", closefd=False)
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)  # libraries regard a different one as that of a graphical shell
