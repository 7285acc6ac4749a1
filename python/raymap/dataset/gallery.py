"""The page of a data set."""

from __future__ import annotations

import html
import json
import os
from pathlib import Path
from typing import Any
from urllib.parse import quote

from .files import printable, readable
from .work import Job

#: Most pictures at once; a browser gets slow beyond.
_PAGE_SIZE = 1000

_STYLE = """
body { font: 14px sans-serif; margin: 1em; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(144px, 1fr)); gap: 1em; }
figure { margin: 0; max-width: 288px; }
figure img { display: block; width: 100%; height: auto; background: #eee; }
figcaption p { margin: 0; }
figcaption, td { overflow-wrap: anywhere; }
td { padding: 0.2em 1em 0.2em 0; vertical-align: top; }
nav { display: flex; flex-wrap: wrap; gap: 0.5em 1em; align-items: center; margin-bottom: 1em; }
nav, nav * { font-size: 16px; }
"""

#: Keys of a figure by which the page sorts, largest first, and their names.
_ORDERS = {"triangles": "triangles", "edges": "boundary edges", "area": "area", "warnings": "warnings"}

# Shows the chosen figures, and makes those that were not in the page. Without it, the first page stands as it is.
_SCRIPT = """
const figures = JSON.parse(document.getElementById("figures").textContent);
const [filter, order, back, on] = ["filter", "order", "back", "on"].map(id => document.getElementById(id));
const place = document.getElementById("place"), main = document.querySelector("main");
const made = new Map([...main.children].map((element, i) => [figures[i], element]));
let first = 0;
function make(figure) {
  const element = main.appendChild(document.createElement("figure"));
  const link = element.appendChild(document.createElement("a"));
  link.href = figure.link;
  const image = link.appendChild(new Image(192, 144));
  [image.loading, image.alt, image.src] = ["lazy", "", figure.image];
  const caption = element.appendChild(document.createElement("figcaption"));
  caption.innerText = figure.caption;
  if (figure.page) {
    const page = caption.appendChild(document.createElement("p")).appendChild(document.createElement("a"));
    [page.href, page.innerText] = [figure.page, "Look at it"];
  }
  made.set(figure, element);
  return element;
}
function show() {
  const words = filter.value.toLowerCase().split(/\\s+/);
  const chosen = figures.filter(figure => words.every(word => figure.text.includes(word)));
  if (order.value) chosen.sort((a, b) => b[order.value] - a[order.value]);
  first = Math.max(0, Math.min(first, Math.floor((chosen.length - 1) / SIZE) * SIZE));
  const shown = chosen.slice(first, first + SIZE);
  main.replaceChildren(...shown.map(figure => made.get(figure) ?? make(figure)));
  place.textContent = shown.length ? `${first + 1} to ${first + shown.length} of ${chosen.length}` : "none";
  [back.disabled, on.disabled] = [first === 0, first + SIZE >= chosen.length];
}
filter.oninput = order.onchange = () => { first = 0; show(); };
back.onclick = () => { first -= SIZE; show(); };
on.onclick = () => { first += SIZE; show(); };
document.querySelector("nav").hidden = false;
show();
""".replace("SIZE", str(_PAGE_SIZE))


def gallery(rows: list[tuple[Job, dict[str, Any]]], table: str, others: list[str]) -> str:
    """Returns the page: what is not done, and a picture of each mesh that is.

    It holds the figures of all meshes, to sort and filter them, and shows a thousand at a time.
    """
    done = [(job, row) for job, row in rows if row["state"] == "done"]
    failed = [(job, row) for job, row in rows if row["state"] != "done"]
    parts = [
        f"<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><title>Data set</title><style>{_STYLE}</style>",
        "<meta name=viewport content='width=device-width, initial-scale=1'>",
        f"<h1>{len(done)} of {len(rows)} meshes done</h1>",
        f'<p><a href="{table}">Table of all meshes</a></p>',
    ]
    if failed:
        parts += ["<h2>Not done</h2>", "<table>", *(_failed(job, row) for job, row in failed), "</table>"]
    if others:
        parts += ["<h2>Of other options, formats or meshes</h2>", "<table>", *map(_other, others), "</table>"]
    figures = [_figure(job, row) for job, row in done]
    parts += ["<h2>Done</h2>", _controls(), "<main>", *map(_element, figures[:_PAGE_SIZE]), "</main>"]
    if len(figures) > _PAGE_SIZE:
        parts.append(f"<noscript>The first {_PAGE_SIZE} are shown; the table has all.</noscript>")
    data = json.dumps(figures, separators=(",", ":")).replace("<", "\\u003c")
    parts += [f"<script type=application/json id=figures>{data}</script>", f"<script>{_SCRIPT}</script>", "</html>"]
    return "\n".join(parts) + "\n"


def _controls() -> str:
    orders = "".join(f"<option value={key}>{name}</option>" for key, name in _ORDERS.items())
    return (
        "<nav hidden><input id=filter type=search placeholder='Name, finding or warning' aria-label=Filter>"
        f"<label>Sort by <select id=order><option value=''>name</option>{orders}</select></label>"
        "<button id=back>Previous</button><button id=on>Next</button><span id=place role=status></span></nav>"
    )


def _failed(job: Job, row: dict[str, Any]) -> str:
    name = html.escape(row["mesh"])
    if row["state"] == "quarantined":
        name = f'<a href="{_link(job, job.quarantine / "log.txt")}">{name}</a>'
    return f"<tr><td>{name}<td>{html.escape(row['reason'] or row['state'])}"


def _other(name: str) -> str:
    return f'<tr><td><a href="{_quoted(name)}">{html.escape(printable(readable(name)))}</a>'


def _figure(job: Job, row: dict[str, Any]) -> dict[str, Any]:
    """Returns what the page shows of a mesh, and the text that the filter looks in."""
    found = "watertight" if row["watertight"] else f"{row['boundary_edges']} boundary edges"
    words = [row["mesh"], found, row.get("verdict_kind", ""), row["warning_codes"], "warnings" if row["warnings"] else ""]
    return {
        "link": _link(job, job.result),
        "image": _link(job, job.thumbnail),
        "page": _link(job, job.page) if job.page.exists() else "",
        "caption": f"{row['mesh']}\n{row['triangles']} triangles, {found}",
        "text": " ".join(words).replace("_", " ").lower(),
        "triangles": row["triangles"],
        "edges": row["boundary_edges"],
        "area": row["area"],
        "warnings": len(row["warning_codes"].split()),
    }


def _element(figure: dict[str, Any]) -> str:
    caption = html.escape(figure["caption"]).replace("\n", "<br>")
    if figure["page"]:
        caption += f'<p><a href="{html.escape(figure["page"])}">Look at it</a></p>'
    return (
        f'<figure><a href="{html.escape(figure["link"])}"><img src="{html.escape(figure["image"])}" alt="" loading=lazy '
        f"width=192 height=144></a><figcaption>{caption}</figcaption></figure>"
    )


def _link(job: Job, path: Path) -> str:
    return _quoted(os.path.relpath(path, job.out))


def _quoted(path: str) -> str:
    return quote(os.fsencode(path))
