"""``python -m mpm_lab`` is ``mpm-lab``."""

import sys

from mpm_lab import main

if __name__ == "__main__":
    sys.exit(main())
