"""Runs the examples of all docstrings and pages."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import shutil
from pathlib import Path

import numpy as np
import pytest
import raymap
from conftest import ROOT
from pages import run_page, run_test

FOUND = [module.name for module in pkgutil.walk_packages(raymap.__path__, "raymap.")]
MODULES = ["raymap", *(name for name in FOUND if name not in ("raymap._raymap", "raymap.jax", "raymap.torch"))]
PAGES = ["README.md", "docs/python.md", "docs/datasets.md", "docs/samples.md", "docs/huge_fields.md", "python/README.md"]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name: str) -> None:
    module = importlib.import_module(name)
    for test in doctest.DocTestFinder().find(module, name, globs={"raymap": raymap, "np": np}):
        run_test(test)


@pytest.mark.parametrize("page", PAGES)
def test_pages(page: str) -> None:
    shutil.copy("ball.ply", "scan.ply")
    run_page(Path(ROOT, page).read_text(), page)


def test_everything_public_has_a_docstring() -> None:
    for name in raymap.__all__:
        value = getattr(raymap, name)
        if not callable(value):
            continue
        assert value.__doc__, name
        for member in vars(value) if isinstance(value, type) else ():
            if not member.startswith("_") and callable(getattr(value, member)):
                assert getattr(value, member).__doc__, f"{name}.{member}"
