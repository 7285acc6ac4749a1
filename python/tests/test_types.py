"""Checks types: the package itself, its stub, and a program that uses it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import raymap

PACKAGE = Path(raymap.__file__).parent
PROGRAM = Path(__file__).with_name("typed_program.py")


@pytest.mark.parametrize("checked", [PACKAGE, PROGRAM], ids=["package", "program"])
def test_types(checked: Path, tmp_path: Path) -> None:
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--allow-any-generics", "--cache-dir", str(tmp_path), str(checked)],
        capture_output=True,
        text=True,
        env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


def test_the_program_runs(tmp_path: Path) -> None:
    ran = subprocess.run([sys.executable, str(PROGRAM)], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr


def test_the_package_is_marked_as_typed() -> None:
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "_raymap.pyi").exists()
