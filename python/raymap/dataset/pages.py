"""The table and the page of a data set."""

from __future__ import annotations

import csv
import html
import importlib
import io
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from urllib.parse import quote

from .._errors import UsageError
from .._raymap import write_whole
from .files import readable
from .work import KINDS, Job, Outcome, read_marker


def parquet_path(table: str | os.PathLike[str]) -> Path:
    """Returns the path of a table. Raises what would be found out at the end of a run only."""
    path = Path(table).resolve()
    if path.suffix.lower() != ".parquet":
        raise UsageError(f"{table}: the table is written as .parquet, and always as table.csv")
    try:
        importlib.import_module("pyarrow.parquet")
    except ImportError:
        raise UsageError(f"{table}: a table in Parquet needs pyarrow: pip install 'raymap[parquet]'") from None
    return path


def page_paths(out: Path, what: str) -> tuple[Path, Path]:
    """Returns the paths of the table and of the page."""
    return out / f"table{KINDS[what]}.csv", out / f"index{KINDS[what]}.html"


def write_pages(
    jobs: Iterable[Job], outcomes: Iterable[Outcome], others: list[str], pages: tuple[Path, Path], parquet: Path | None
) -> None:
    """Writes the table and the page from the markers of all meshes. They hold no times: runs can be compared.

    Writes the table as Parquet, too, if there is a path for it. The page also lists other results of the folder.

    Raises:
        FileError: A file cannot be written.
    """
    unfinished = {outcome.name: outcome.reason for outcome in outcomes if outcome.state == "unfinished"}
    rows = [(job, _row(job, unfinished)) for job in jobs]
    table_path, page_path = pages
    columns = list(dict.fromkeys(name for _, row in rows for name in row))
    text = io.StringIO()
    table = csv.DictWriter(text, columns, lineterminator="\n")
    table.writeheader()
    table.writerows(row for _, row in rows)
    write_whole(table_path, text.getvalue().encode())
    if parquet is not None:
        write_whole(parquet, _parquet(columns, [row for _, row in rows]))
    write_whole(page_path, _page(rows, table_path.name, others).encode())


def _parquet(columns: list[str], rows: list[dict[str, Any]]) -> bytes:
    """Returns a table in which cells without a value are null."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    values = {name: [None if row.get(name, "") == "" else row[name] for row in rows] for name in columns}
    content = arrow.BufferOutputStream()
    parquet.write_table(arrow.table(values), content)
    return bytes(content.getvalue())


def _row(job: Job, unfinished: dict[str, str]) -> dict[str, Any]:
    marker = None if job.name in unfinished else read_marker(job.marker)
    if marker is None:
        marker = {"state": "unfinished", "reason": unfinished.get(job.name, "")}
    return {
        "mesh": readable(job.name),
        "state": marker["state"],
        "reason": marker.get("reason", ""),
        "warnings": "; ".join(warning["message"] for warning in marker.get("warnings", [])),
        "warning_codes": " ".join(dict.fromkeys(warning["code"] for warning in marker.get("warnings", []))),
        "mesh_sha256": marker.get("mesh_sha256", ""),
        **_cells(marker.get("info", {})),
        **_cells(marker.get(job.what, {})),
    }


def _cells(figures: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Returns a cell for each figure, also of records, positions and boxes in it, but not of lists of records."""
    cells: dict[str, Any] = {}
    for name, value in figures.items():
        match value:
            case [] | [dict(), *_]:
                continue
            case [[*low], [*high]]:
                value = {"min": low, "max": high}
            case [x, y, z]:
                value = {"x": x, "y": y, "z": z}
        cells |= _cells(value, f"{prefix}{name}_") if isinstance(value, dict) else {prefix + name: value}
    return cells


_STYLE = """
body { font: 14px sans-serif; margin: 2em; }
main { display: flex; flex-wrap: wrap; gap: 1em; }
figure { margin: 0; width: 192px; }
figure img { display: block; background: #eee; }
figcaption, td { overflow-wrap: anywhere; }
td { padding: 0.2em 1em 0.2em 0; vertical-align: top; }
"""


def _page(rows: list[tuple[Job, dict[str, Any]]], table: str, others: list[str]) -> str:
    done = [(job, row) for job, row in rows if row["state"] == "done"]
    failed = [(job, row) for job, row in rows if row["state"] != "done"]
    parts = [
        f"<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><title>Data set</title><style>{_STYLE}</style>",
        f"<h1>{len(done)} of {len(rows)} meshes done</h1>",
        f'<p><a href="{table}">Table of all meshes</a></p>',
    ]
    if failed:
        parts += ["<h2>Not done</h2>", "<table>", *(_failed(job, row) for job, row in failed), "</table>"]
    if others:
        parts += ["<h2>Of other options, formats or meshes</h2>", "<table>", *map(_other, others), "</table>"]
    parts += ["<h2>Done</h2>", "<main>", *(_figure(job, row) for job, row in done), "</main>", "</html>"]
    return "\n".join(parts) + "\n"


def _failed(job: Job, row: dict[str, Any]) -> str:
    name = html.escape(row["mesh"])
    if row["state"] == "quarantined":
        name = f'<a href="{_link(job, job.quarantine / "log.txt")}">{name}</a>'
    return f"<tr><td>{name}<td>{html.escape(row['reason'] or row['state'])}"


def _other(name: str) -> str:
    return f'<tr><td><a href="{_quoted(name)}">{html.escape(readable(name))}</a>'


def _figure(job: Job, row: dict[str, Any]) -> str:
    watertight = "watertight" if row["watertight"] else f"{row['boundary_edges']} boundary edges"
    return (
        f'<figure><a href="{_link(job, job.result)}"><img src="{_link(job, job.thumbnail)}" alt="" loading=lazy '
        f"width=192 height=144></a><figcaption>{html.escape(row['mesh'])}<br>{row['triangles']} triangles, {watertight}"
        "</figcaption></figure>"
    )


def _link(job: Job, path: Path) -> str:
    return _quoted(os.path.relpath(path, job.out))


def _quoted(path: str) -> str:
    return html.escape(quote(os.fsencode(path)))
