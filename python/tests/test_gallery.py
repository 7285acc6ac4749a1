"""The page of a data set."""

import json
import re
from typing import Any

import pytest
from raymap.dataset.gallery import gallery
from raymap.dataset.work import Job


def job(name: str) -> Job:
    return Job("", name, "out", "field", "npz", {}, 1, 0, 0.0, False)


def row(name: str, **others: Any) -> dict[str, Any]:
    figures = {"triangles": 4, "boundary_edges": 0, "area": 1.5, "watertight": True, "verdict_kind": "clean_solid"}
    return {"mesh": name, "state": "done", "reason": "", "warnings": "", "warning_codes": "", **figures, **others}


def figures_of(page: str) -> list[dict[str, Any]]:
    return json.loads(re.search(r"<script type=application/json id=figures>(.*?)</script>", page)[1])


def test_the_page_holds_what_it_sorts_and_filters_by() -> None:
    open_row = row("b.ply", watertight=False, boundary_edges=3, verdict_kind="open_solid",
                   warnings="odd", warning_codes="file_content solid_lost")
    first, second = figures_of(gallery([(job("a.ply"), row("a.ply")), (job("b.ply"), open_row)], "table.csv", []))
    assert first == {"link": "a.ply.npz", "image": "a.ply.png", "page": "", "caption": "a.ply\n4 triangles, watertight",
                     "text": "a.ply watertight clean solid  ", "triangles": 4, "edges": 0, "area": 1.5, "warnings": 0}
    assert second["caption"] == "b.ply\n4 triangles, 3 boundary edges" and second["warnings"] == 2
    assert second["text"] == "b.ply 3 boundary edges open solid file content solid lost warnings"


def test_a_phone_shows_it_at_its_own_width() -> None:
    assert "<meta name=viewport content='width=device-width, initial-scale=1'>" in gallery([], "table.csv", [])


def test_names_are_neither_markup_nor_the_end_of_the_data() -> None:
    name = "</script><b>&'\"#1.ply"
    page = gallery([(job("x.ply"), row(name))], "table.csv", [])
    assert figures_of(page)[0]["caption"].startswith(name)
    assert page.count("</script>") == 2 and "<b>" not in page


@pytest.mark.parametrize(("count", "shown", "note"), [(1000, 1000, False), (1001, 1000, True)])
def test_a_thousand_are_shown_at_a_time(count: int, shown: int, note: bool) -> None:
    page = gallery([(job(f"{i}.ply"), row(f"{i}.ply")) for i in range(count)], "table.csv", [])
    assert page.count("<figure>") == shown and len(figures_of(page)) == count
    assert ("<noscript>" in page) == note
    assert f"<h1>{count} of {count} meshes done</h1>" in page
