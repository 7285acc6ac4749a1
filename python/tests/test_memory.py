"""Limits of the memory of the process."""

from __future__ import annotations

import subprocess
import sys

import pytest
import raymap


def test_the_limit_of_the_process(ball: raymap.Mesh) -> None:
    raymap.limit_memory(1)
    try:
        assert raymap.memory_left() == 0
        with pytest.raises(raymap.MemoryLimitError, match=" may be used; use a lower resolution"):
            raymap.generate(ball, resolution=16, device="cpu")
        raymap.limit_memory(1 << 50)
        assert 0 < raymap.memory_left() < 1 << 50
    finally:
        raymap.limit_memory(None)
    assert raymap.generate(ball, resolution=16, device="cpu").arrays == ("distance",)


def test_a_strict_limit_makes_allocations_fail() -> None:
    code = "\n".join(
        [
            "import raymap",
            "held = int(open('/proc/self/status').read().split('VmRSS:')[1].split()[0]) << 10",
            "raymap.limit_memory(held + (64 << 20), strict=True)",
            "bytearray(16 << 20)",
            "try: bytearray(256 << 20)",
            "except MemoryError: print('refused')",
        ]
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "refused\n"


def test_limits_that_make_no_sense() -> None:
    for bytes in (0, -1, 2**64):
        with pytest.raises(raymap.UsageError, match="bytes must be"):
            raymap.limit_memory(bytes)
    with pytest.raises(TypeError):
        raymap.limit_memory(1.5)  # type: ignore[arg-type]
    with pytest.raises(raymap.MemoryLimitError, match="this process needs at least"):
        raymap.limit_memory(1, strict=True)
