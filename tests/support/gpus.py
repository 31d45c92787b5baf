"""The GPU of the tests: Vulkan, by Mesa's driver, which runs on the processor, where there is no better; or what
``MPM_LAB_TEST_GPU`` names, ``cuda`` or ``vulkan``."""

import os

import pytest

from solvers.solver import gpu_detection

ARCH = os.environ.get("MPM_LAB_TEST_GPU", "vulkan")
HOW = "no {} device was found ({}): install one (Debian: apt-get install mesa-vulkan-drivers) to run these tests"


def require_gpu() -> None:
    """Skip the test with a word where there is none; where CI is set, fail."""
    if missing := gpu_detection.probe_device(ARCH)["missing"]:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(HOW.format(gpu_detection.TITLES[ARCH], missing))
