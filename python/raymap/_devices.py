"""Devices that can compute fields."""

from __future__ import annotations

import subprocess
import sys

from . import _raymap
from ._errors import warn
from ._progress import Progress, reporting
from ._records import DeviceInfo, DeviceTest

_TEST_SECONDS = 300.0  # The test itself gives up sooner where a check hangs.


def devices() -> list[DeviceInfo]:
    """Returns all values that the argument ``device`` accepts, the CPU first.

    Asks every Vulkan driver, which can take a second.

    >>> raymap.devices()[0]["id"]
    'cpu'
    """
    return _raymap.devices()


def test_device(id: str, *, progress: Progress = None) -> DeviceTest:
    """Compares every stage and whole fields on a GPU with the CPU, and keeps the result in the user's cache folder.

    A faulty driver may end the process.

    Returns:
        Its checks, and as ``problem`` the first difference; empty if there is none.

    Raises:
        UsageError: The name is not that of a GPU.
        UnsupportedError: There is no such device, or another process tests it now.
    """
    with reporting(progress) as report:
        return _raymap.test_device(id, report)  # type: ignore[return-value]


test_device.__test__ = False  # type: ignore[attr-defined]  # pytest takes it for a test.


def tested(device: str) -> str:
    """Returns the device to use. Before ``"auto"`` takes a GPU for the first time, a process of its own tests it."""
    gpu = _raymap.device_to_test() if device == "auto" else ""
    if not gpu:
        return device
    code = f"import sys, raymap; sys.exit(raymap.test_device({gpu!r})['problem'] != '')"
    try:
        test = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=_TEST_SECONDS, check=False)
        if test.returncode == 0 or _raymap.device_to_test() != gpu:
            return device
    except (OSError, subprocess.TimeoutExpired):
        pass
    text = f"the CPU is used instead of the GPU: the test of {gpu} did not pass; test it again to see why"
    warn("device_refused", text, {"device": gpu})
    return "cpu"
