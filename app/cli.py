"""The entry of the command line ``mpm-lab``, light enough that Ctrl-C is one line even while the rest loads."""

import sys

INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    """Run the command line (default: what the process was given) and return its exit status."""
    try:
        from app.commands.dispatch import dispatch
        return dispatch(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:
        print("mpm-lab: interrupted", file=sys.stderr, flush=True)
        return INTERRUPTED
