"""The table and the page of a data set."""

from __future__ import annotations

import csv
import importlib
import io
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .._errors import UsageError
from .._raymap import write_whole
from .files import printable, readable
from .gallery import gallery
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
    table.writerows({name: _cell(value) for name, value in row.items()} for _, row in rows)
    write_whole(table_path, text.getvalue().encode())
    if parquet is not None:
        write_whole(parquet, _parquet(columns, [row for _, row in rows]))
    write_whole(page_path, gallery(rows, table_path.name, others).encode())


def _parquet(columns: list[str], rows: list[dict[str, Any]]) -> bytes:
    """Returns a table in which cells without a value are null. pandas reads its whole numbers as such."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    values = {name: [None if row.get(name, "") == "" else row[name] for row in rows] for name in columns}
    content = arrow.BufferOutputStream()
    table = arrow.table(values)
    parquet.write_table(table.replace_schema_metadata({"pandas": json.dumps(_pandas(table.schema))}), content)
    return bytes(content.getvalue())


def _pandas(schema: Any) -> dict[str, Any]:
    """Returns what tells pandas to read columns with missing cells as whole numbers and booleans, not as floats."""
    kinds = {"int64": "Int64", "bool": "boolean"}
    columns = [
        {"name": field.name, "field_name": field.name, "pandas_type": str(field.type), "metadata": None,
         "numpy_type": kinds[str(field.type)]}
        for field in schema
        if str(field.type) in kinds
    ]  # fmt: skip
    return {"index_columns": [], "column_indexes": [], "columns": columns, "pandas_version": "2"}


def _cell(value: Any) -> Any:
    """Returns a cell of the table. Spreadsheets take a text that begins so for a formula, unless a ' is before it."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@")) else value


def _row(job: Job, unfinished: dict[str, str]) -> dict[str, Any]:
    marker = None if job.name in unfinished else read_marker(job.marker)
    if marker is None:
        marker = {"state": "unfinished", "reason": unfinished.get(job.name, "")}
    return {
        "mesh": printable(readable(job.name)),
        "state": marker["state"],
        "reason": printable(marker.get("reason", "")),
        "warnings": printable("; ".join(warning["message"] for warning in marker.get("warnings", []))),
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
