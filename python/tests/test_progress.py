"""What progress=True, "plain" and "json" show."""

from __future__ import annotations

import json
import sys
import types
from collections.abc import Callable

import pytest
import raymap
from raymap import _progress


def generate(mesh, **options):
    return raymap.generate(mesh, resolution=24, device="cpu", **options)


class Terminal:
    def __init__(self) -> None:
        self.text = ""

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass


def test_a_line_of_progress_appears_on_a_terminal_only(ball, monkeypatch, capsys):
    monkeypatch.setattr(_progress, "_QUIET_SECONDS", 0.0)
    generate(ball, progress=True)
    assert capsys.readouterr().err == ""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    generate(ball, progress=True)
    assert "exact_distance" in terminal.text and terminal.text.endswith("\r\033[K")
    monkeypatch.setattr(_progress, "_QUIET_SECONDS", 1000.0)
    terminal.text = ""
    generate(ball, progress=True)
    assert terminal.text == ""
    monkeypatch.setattr(_progress, "_QUIET_SECONDS", 0.0)
    generate(ball, progress="plain")
    assert terminal.text == ""


class Clock:
    """Stands in for time.monotonic."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now

    def show(self, shown: Callable[[str, float], object], *reports: tuple[float, str, float]) -> None:
        """Reports a stage and its share at each second."""
        for second, stage, done in reports:
            self.now = 1000.0 + second
            shown(stage, done)


def test_without_a_terminal_progress_is_a_line_a_minute(monkeypatch, capsys):
    clock = Clock()
    monkeypatch.setattr(_progress, "_now", clock)
    for progress in (True, "plain"):
        clock.now = 1000.0
        with _progress.reporting(progress) as shown:
            clock.show(shown, (0, "sign", 0.0), (59.9, "sign", 0.2))
            assert capsys.readouterr().err == ""
            clock.show(shown, (60, "sign", 0.454), (119, "sign", 0.5), (121, "finish", 1.0))
        assert capsys.readouterr().err == "raymap: 60 s: sign 45 %\nraymap: 121 s: finish 100 %\n"


def test_progress_as_json_is_an_object_a_stage_and_a_second(ball, monkeypatch, capsys):
    clock = Clock()
    with monkeypatch.context() as patched:
        patched.setattr(_progress, "_now", clock)
        shown = _progress._Json()
        clock.show(shown, (0.25, "sign", 0.0), (1, "sign", 0.1), (1.25, "sign", 0.12345), (1.5, "2 s left,", 1))
    assert [json.loads(line) for line in capsys.readouterr().err.splitlines()] == [
        {"stage": "sign", "done": 0.0, "seconds": 0.25},
        {"stage": "sign", "done": 0.123, "seconds": 1.25},
        {"stage": "2 s left", "done": 1, "seconds": 1.5},
    ]
    generate(ball, progress="json")
    stages = [json.loads(line)["stage"] for line in capsys.readouterr().err.splitlines()]
    assert "exact_distance" in stages


class Handle:
    """What IPython.display.display returns."""

    def __init__(self, contents: list[dict[str, str]]) -> None:
        self.contents = contents

    def update(self, content: dict[str, str], raw: bool) -> None:
        assert raw
        self.contents.append(content)


@pytest.mark.parametrize("shell", [None, types.SimpleNamespace(), types.SimpleNamespace(kernel=1)])
def test_in_a_notebook_progress_is_a_bar(ball, monkeypatch, capsys, shell):
    contents: list[dict[str, str]] = []

    def display(content: dict[str, str], raw: bool, display_id: bool) -> Handle:
        assert raw and display_id and not contents
        contents.append(content)
        return Handle(contents)

    monkeypatch.setattr(_progress, "_QUIET_SECONDS", 0.0)
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(display=display))
    generate(ball, progress=True)
    assert capsys.readouterr().err == ""
    if not hasattr(shell, "kernel"):
        assert contents == []
        return
    assert contents[0]["text/plain"].endswith(" %") and "<progress value='" in contents[0]["text/html"]
    assert contents[-1] == {"text/plain": "", "text/html": ""}
    contents.clear()
    clock = Clock()
    monkeypatch.setattr(_progress, "_now", clock)
    monkeypatch.setattr(_progress, "_QUIET_SECONDS", 1.0)
    bar = _progress._Bar(display)
    bar.clear()
    assert contents == []
    clock.show(bar, (0.9, "a", 0.1), (1, "a<b", 0.454))
    text = {"text/plain": "a<b 45 %", "text/html": "<progress value='0.454'></progress> a&lt;b 45 %"}
    assert contents == [text]
