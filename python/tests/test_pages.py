"""Pages of fields, in notebooks and outside of them."""

from __future__ import annotations

import html
import importlib.util
import json
import re
import sys
import types
import webbrowser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import pytest
import raymap
from conftest import make_ball

SMALL: dict[str, Any] = {"width": 64, "height": 48, "device": "cpu"}


@pytest.fixture(scope="module")
def field() -> raymap.Field:
    arrays = ("distance", "winding", "confidence")
    return raymap.generate(*make_ball(2), resolution=16, device="cpu", arrays=arrays)


def data_of(page: str) -> dict[str, Any]:
    found = re.search(r'id="page">(.*?)</script>', page)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


def test_a_page_has_what_was_asked_for(field: raymap.Field) -> None:
    data = data_of(field.to_html(**SMALL))
    assert data["dims"] == list(field.shape) and data["spacing"] == field.spacing
    assert [array["name"] for array in data["arrays"]] == ["distance", "winding number", "confidence"]
    assert (data["colours"], data["defects"], data["height"]) == ("distance", [], 48)
    assert data["fields"][0]["name"] == "Field"
    assert data["fields"][0]["shape"]["cutNormal"] == [0, 0, 0]

    vertices, faces = make_ball(2)
    data = data_of(
        field.to_html(title="a ball", mesh=(vertices, faces[1:]), array="confidence", max_size=8, cut=True, **SMALL)
    )
    assert data["fields"][0]["name"] == "a ball" and data["colours"] == "confidence"
    assert max(data["dims"]) == 8
    assert [(kind["name"], kind["count"], kind["places"]) for kind in data["defects"]] == [("Holes", 3, 1)]
    assert data["fields"][0]["shape"]["cutNormal"] != [0, 0, 0]
    assert data_of(field.to_html(mesh=raymap.Mesh(vertices, faces), **SMALL))["defects"] == []

    other = raymap.generate(*make_ball(2), resolution=12, device="cpu")
    data = data_of(field.to_html(other=other, other_title="rough", **SMALL))
    assert [each["name"] for each in data["fields"]] == ["Field", "rough"]


def test_a_narrow_band_is_shown_by_its_surface() -> None:
    ball = make_ball(2)
    band = raymap.generate(*ball, resolution=60, band=2, sparse=True, arrays=("distance", "winding"))
    other = raymap.generate(*ball, resolution=12, device="cpu")
    page = band.to_html(other=other, max_size=20, **SMALL)
    data, turned = data_of(page), data_of(other.to_html(other=band, other_title="band", **SMALL))
    assert data["dims"] == [20, 20, 20] and turned["dims"] == [12, 12, 12]
    assert [each["name"] for each in turned["fields"]] == ["Field", "band"]
    assert "<td>60 × 60 × 60</td>" in page and "distances to its surface" in page
    alone = data_of(band.to_html(**SMALL))
    assert alone["dims"] == [60, 60, 60] and [array["name"] for array in alone["arrays"]] == ["distance"]
    whole, shown = raymap.generate(*ball, resolution=60, device="cpu"), alone["arrays"][0]
    for found, expected in (("least", whole.distance.min()), ("most", whole.distance.max())):
        assert shown[found] * alone["spacing"] == pytest.approx(expected, abs=3e-3) and abs(expected) > 5 * band.inside
    with pytest.raises(raymap.UsageError, match="draw it as a picture"):
        band.to_html(array="winding", **SMALL)
    with pytest.raises(raymap.UsageError, match="no sample of the narrow band is inside"):
        raymap.generate(*ball, resolution=30, sign="none", sparse=True).to_html(**SMALL)
    with pytest.raises(raymap.UsageError, match="other must be a field, not a tuple"):
        band.to_html(other=ball, **SMALL)  # type: ignore[arg-type]


def test_a_page_is_written_whole(field: raymap.Field, tmp_path: Path) -> None:
    field.to_html(tmp_path / "my ball.html", **SMALL)
    written = (tmp_path / "my ball.html").read_text(encoding="utf-8")
    assert written == field.to_html(title="my ball", **SMALL)
    with pytest.raises(raymap.FileError):
        field.to_html(tmp_path / "none" / "page.html", **SMALL)
    assert [path.name for path in tmp_path.glob("**/*page*")] == []


def test_wrong_arguments_are_named(field: raymap.Field) -> None:
    with pytest.raises(raymap.UsageError, match="at least 2 samples"):
        field.to_html(max_size=1, **SMALL)
    with pytest.raises(raymap.UsageError, match="winding numbers"):
        raymap.generate(*make_ball(2), resolution=8, device="cpu").to_html(array="winding", **SMALL)
    with pytest.raises(raymap.UsageError, match="of two fields"):
        field.to_html(array="winding", other=field, **SMALL)
    with pytest.raises(TypeError, match="title must be a text"):
        field.to_html(title=3, **SMALL)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="size"):
        field.show(size=3)  # type: ignore[call-arg]
    with pytest.raises(raymap.UsageError, match="frame_height"):
        field.show(frame_height=0, **SMALL)


def frame_of(content: dict[str, str]) -> str:
    found = re.fullmatch(r"<iframe srcdoc='([^']*)' sandbox='allow-scripts' style='[^']*;height:300px;[^']*'></iframe>", content["text/html"])
    assert found
    return html.unescape(found[1])


def test_in_a_notebook_a_page_appears_in_the_cell(field: raymap.Field, monkeypatch: pytest.MonkeyPatch) -> None:
    contents: list[dict[str, str]] = []
    kernel = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=1))
    monkeypatch.setitem(sys.modules, "IPython", kernel)
    display = types.SimpleNamespace(display=lambda content, raw: contents.append(content))
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    field.show(frame_height=300, title="it's", **SMALL)
    assert len(contents) == 1
    assert frame_of(contents[0]) == field.to_html(title="it's", **SMALL)


@pytest.mark.skipif(importlib.util.find_spec("IPython") is None, reason="IPython is not installed")
def test_ipython_publishes_the_page(field: raymap.Field, monkeypatch: pytest.MonkeyPatch) -> None:
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    shell = InteractiveShell.instance()
    monkeypatch.setattr(shell, "kernel", 1, raising=False)
    shell.push({"field": field, "small": SMALL})
    try:
        with capture_output() as captured:
            shell.run_cell("field.show(frame_height=300, **small)").raise_error()
    finally:
        InteractiveShell.clear_instance()
    assert [frame_of(output.data)[:15] for output in captured.outputs] == ["<!DOCTYPE html>"]


@pytest.mark.parametrize("is_opened", [True, False])
def test_elsewhere_a_page_opens_in_a_browser(
    field: raymap.Field, is_opened: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or is_opened)
    field.show(title="ball", **SMALL)
    assert len(opened) == 1
    path = Path(unquote(urlparse(opened[0]).path))
    assert path.parent == tmp_path and path.suffix == ".html"
    assert path.read_text(encoding="utf-8") == field.to_html(title="ball", **SMALL)
    printed = capsys.readouterr().out
    assert (str(path) in printed) is not is_opened
