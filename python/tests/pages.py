"""Runs the code of pages as it stands. Also used in a bare system, which has no pytest."""

from __future__ import annotations

import doctest
import re


def run_test(test: doctest.DocTest) -> None:
    report: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.FAIL_FAST)
    if runner.run(test, out=report.append).failed:
        raise AssertionError("".join(report))


def code_of(text: str, name: str) -> str:
    """Returns all Python blocks of a page, one after the other: doctests, or a program."""
    code = "\n".join(re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    assert code, f"{name} has no Python"
    return code


def run_page(text: str, name: str) -> None:
    """Runs the Python code of a page."""
    code = code_of(text, name)
    if ">>>" in code:
        run_test(doctest.DocTestParser().get_doctest(code, {}, name, name, 0))
    else:
        exec(compile(code, name, "exec"), {})
