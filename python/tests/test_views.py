"""How results look in terminals and notebooks."""

import json
import math
import pickle
from html.parser import HTMLParser

import numpy as np
import pytest
import raymap
from conftest import make_ball


def results() -> dict[str, object]:
    mesh = raymap.Mesh(*make_ball(3))
    surface = raymap.Surface(mesh)
    points = np.random.default_rng(1).uniform(-1, 1, (5000, 3))
    field = raymap.generate(mesh, resolution=16, device="cpu")
    return {
        "info": raymap.info(mesh),
        "stats": field.stats,
        "devices": raymap.devices(),
        "repaired": raymap.repair(mesh, resolution=24, device="cpu"),
        "report": raymap.repair(mesh, resolution=24, device="cpu").report,
        "simplified": raymap.simplify(mesh, tolerance=0.05),
        "samples": raymap.sample_points(mesh, 5000),
        "query": surface.query(points, ("distance", "triangle")),
        "closest": surface.closest(points),
        "faces": raymap.sample_faces(mesh, step=0.1),
        "thickness": surface.thickness(points, np.zeros(5000, np.uint32)),
        "summary": surface.thickness_summary(),
        "field": field,
        "comparison": field.compare(field),
    }


@pytest.fixture(scope="module")
def shown() -> dict[str, object]:
    return results()


def test_results_fit_a_screen(shown: dict[str, object]) -> None:
    for name, result in shown.items():
        lines = repr(result).splitlines()
        assert len(lines) <= 40, name
        assert max(map(len, lines)) <= 100, name


def test_every_value_has_a_line(shown: dict[str, object]) -> None:
    info = shown["info"]
    lines = dict(line.split(maxsplit=1) for line in repr(info).splitlines())
    assert list(lines) == list(info)
    assert lines["triangles"] == "1280" and lines["watertight"] == "True"
    samples = repr(shown["samples"]).splitlines()
    assert samples[0] == "raymap.Samples" and samples[1].split() == ["points", "(5000,", "3)", "float64,", *samples[1].split()[4:]]
    low, high = shown["samples"].points.min(), shown["samples"].points.max()
    assert samples[1].endswith(f"{low:.6g} to {high:.6g}")
    assert len(repr(shown["devices"]).splitlines()) == len(shown["devices"])


class Cells(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def test_notebooks_show_the_same_as_a_table(shown: dict[str, object]) -> None:
    for name, result in shown.items():
        if name == "field":
            continue
        page = Cells()
        page.feed(result._repr_html_())
        texts = "".join(page.texts)
        keys = result._asdict() if hasattr(result, "_asdict") else result[0] if isinstance(result, list) else result
        assert all(key in texts for key in keys), name


def test_text_of_files_is_no_markup() -> None:
    record = type(raymap.info(raymap.Mesh(*make_ball(1))))({"<b>": "a & <script>"})
    assert "&lt;script&gt;" in record._repr_html_() and "<script" not in record._repr_html_()
    assert "&lt;b&gt;" in record._repr_html_()


def test_odd_values_have_a_text() -> None:
    record = type(raymap.info(raymap.Mesh(*make_ball(1))))
    nan = np.full(4, np.nan)
    assert repr(record(a=nan)).endswith("(4,) float64, not finite")
    assert repr(record(a=np.array([1, np.inf, 3, 2.0]))).endswith("(4,) float64, 1 to 3")
    assert repr(record(a=np.array(["wall"] * 5))).endswith("(5,) <U4")
    assert repr(record(a=[1, 2, 3, 4])) == "a  4: [1, 2, 3, …]"
    assert repr(record(a=[1, 2, 3])) == "a  [1, 2, 3]"
    assert repr(record(a=None, bc="x\ny")) == "a   None\nbc  x y"
    assert repr(record(a="x" * 200)) == "a  " + "x" * 96 + "…"
    assert repr(record(a="x" * 97)) == "a  " + "x" * 97
    assert repr(record()) == ""


def test_records_stay_dicts(shown: dict[str, object]) -> None:
    info = shown["info"]
    assert isinstance(info, dict) and json.loads(json.dumps(info)) == info
    assert pickle.loads(pickle.dumps(info)) == info
    assert isinstance(shown["devices"], list) and shown["devices"][0]["id"] == "cpu"


def test_numpy_takes_a_field() -> None:
    field = raymap.generate(*make_ball(2), resolution=12, device="cpu")
    assert np.asarray(field).tolist() == field.distance.tolist()
    assert np.shares_memory(np.asarray(field), field.distance)
    assert np.asarray(field, np.float64).dtype == np.float64
    assert not np.shares_memory(np.array(field), field.distance)
    assert math.isclose(float(np.abs(field).min()), float(np.abs(field.distance).min()))
