"""Results as terminals and notebooks show them: a line for each value, whatever its size."""

from __future__ import annotations

import html
from typing import Any, TypeVar

import numpy as np

_WIDTH = 100  # Characters of a line.
_Tuple = TypeVar("_Tuple", bound=tuple[Any, ...])


class Record(dict[str, Any]):
    """A dict that shows as a table. The library's results are such."""

    def __repr__(self) -> str:
        return _table(self)

    def _repr_html_(self) -> str:
        return html_table("", self)


class Records(list[Record]):
    """A list of records that shows as a line for each."""

    def __repr__(self) -> str:
        return "\n".join(_cut(f"{number}: {_short(record)}") for number, record in enumerate(self)) or "[]"

    def _repr_html_(self) -> str:
        return "".join(html_table(str(number), record) for number, record in enumerate(self))


def shown(kind: type[_Tuple]) -> type[_Tuple]:
    """Decorates a class of named tuples that shows as a table below its name."""
    names = list(kind.__annotations__)

    def title(result: Any) -> str:
        return f"raymap.{type(result).__name__}"

    def values(result: Any) -> dict[str, Any]:
        return dict(zip(names, result, strict=True))

    kind.__repr__ = lambda self: f"{title(self)}\n{_table(values(self))}"  # type: ignore[method-assign]
    setattr(kind, "_repr_html_", lambda self: html_table(title(self), values(self)))
    return kind


def _table(values: dict[str, Any]) -> str:
    width = max((len(name) for name in values), default=0)
    return "\n".join(_cut(f"{name:{width}}  {_short(value)}") for name, value in values.items())


def html_table(caption: str, values: dict[str, Any]) -> str:
    """Returns a table with a line for each value."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:left'>{html.escape(_cut(_short(value)))}</td></tr>"
        for name, value in values.items()
    )
    return f"<table><caption>{html.escape(caption)}</caption>{rows}</table>"


def _short(value: Any) -> str:
    """Returns a text of one line."""
    if isinstance(value, np.ndarray):
        return _short_array(value)
    if isinstance(value, dict):
        return ", ".join(f"{name} {_short(each)}" for name, each in value.items())
    if isinstance(value, list):
        some = ", ".join(f"({_short(each)})" if isinstance(each, dict) else _short(each) for each in value[:3])
        return f"[{some}]" if len(value) <= 3 else f"{len(value)}: [{some}, …]"
    if isinstance(value, float):
        return f"{value:.6g}"
    return " ".join(str(value).split())


def _short_array(array: np.ndarray[Any, Any]) -> str:
    if array.size <= 3:
        return np.array2string(array, separator=", ", precision=6)
    text = f"{array.shape} {array.dtype}"
    if array.dtype.kind not in "fiu":
        return text
    finite = array[np.isfinite(array)]
    return f"{text}, {finite.min():.6g} to {finite.max():.6g}" if finite.size > 0 else f"{text}, not finite"


def _cut(line: str) -> str:
    return line if len(line) <= _WIDTH else line[: _WIDTH - 1] + "…"
