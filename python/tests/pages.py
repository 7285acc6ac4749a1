"""Runs the code of pages as it stands. Also used in a bare system, which has no pytest."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from pathlib import Path


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


RUN = {"python": [sys.executable, "-c"], "sh": ["bash", "-ec"]}


def run_lesson(text: str, folder: Path, environment: dict[str, str]) -> None:
    """Runs the blocks of a lesson in a folder. Each must print the block ``text`` behind it, or else nothing.

    Blocks that are neither Python nor sh are files, which their first line names."""
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    for (language, code), (next_language, shown) in zip(blocks, [*blocks[1:], ("", "")]):
        if language not in RUN:
            if language != "text":
                Path(folder, code.split("\n")[0].split()[1]).write_text(code)
            continue
        ended = subprocess.run([*RUN[language], code], cwd=folder, env=environment, text=True, check=False,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip
        assert ended.returncode == 0, f"{code}ends with {ended.returncode}:\n{ended.stdout}"
        expected = shown if next_language == "text" else ""
        is_right = doctest.OutputChecker().check_output(expected, ended.stdout, doctest.ELLIPSIS)
        assert is_right, f"{code}prints\n{ended.stdout}and not\n{expected}"
