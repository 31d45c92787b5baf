"""Vulkan for tests: Mesa's, which runs on the processor, where there is no better."""

import os

import pytest

from solvers import devices

HOW = "no Vulkan device was found ({}): install one (Debian: apt-get install mesa-vulkan-drivers) to run these tests"


def require_vulkan() -> None:
    """Skip the test with a word where there is none; where CI is set, fail."""
    if missing := devices.found("vulkan")["missing"]:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(HOW.format(missing))
