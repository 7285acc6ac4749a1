"""The commands that the program raymap lacks: ``python -m raymap dataset``, ``pack`` and ``field``."""

from __future__ import annotations

import argparse
import importlib
import inspect
import logging
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

from . import dataset, zarr
from ._errors import Error, FileError, UsageError, code_of
from ._frames import Normalization
from ._generate import generate
from ._records import FieldArray
from ._samples import sample_points
from .dataset.files import printable, readable
from .dataset.pages import page_paths
from .recipes import RecipeName

_EXIT_CODES = {  # As those of the program raymap
    "usage": 2,
    "input": 3,
    "file": 4,
    "memory": 5,
    "cancelled": 6,
    "unsupported": 7,
    "device_lost": 8,
    "device_memory": 10,
}
_UNFINISHED = 9
_STOPPED = 130


def main(arguments: list[str] | None = None) -> int:
    """Runs a command. Returns the exit code."""
    warnings.showwarning = _show_warning
    try:
        with _stdout_errors():
            given = vars(_parser().parse_args(arguments))
        return _COMMANDS[given.pop("command")](**given)
    except Error as error:
        print(f"raymap: error: {printable(str(error))}", file=sys.stderr)
        return _EXIT_CODES.get(code_of(error), _UNFINISHED)
    except KeyboardInterrupt:
        print("raymap: stopped; run it again to go on", file=sys.stderr)
        return _STOPPED


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    print(f"raymap: warning: {printable(str(message))}", file=sys.stderr)


@contextmanager
def _stdout_errors() -> Iterator[None]:
    """Turns the system's errors about standard output into FileError."""
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # The rest must not fail again at the end.
        reason = "the program that reads it has ended" if isinstance(error, BrokenPipeError) else error.strerror
        raise FileError(f"standard output: cannot write the text: {reason}") from error


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m raymap", description=_DESCRIPTION)
    commands = parser.add_subparsers(dest="command", required=True)
    _add_dataset(commands.add_parser("dataset", help="make the fields of many meshes", description=_DATASET))
    _add_pack(commands.add_parser("pack", help="pack a data set into shards, for WebDataset or Zarr", description=_PACK))
    _add_field(commands.add_parser("field", help="make a field of any size in a Zarr store", description=_FIELD))
    return parser


_DESCRIPTION = "Makes the signed distance fields of many meshes, or a huge one. Else there is the program raymap."

_DATASET = """Makes the signed distance field of every mesh of a folder, or points with their distances.
It may be stopped and run again at any time: a second run makes what is missing or has changed.
A mesh that fails goes to OUT/quarantine, and the run goes on."""


def _add_dataset(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("meshes", nargs="+", metavar="FOLDER", help="folder of meshes, or meshes")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="folder of the results")
    _add_arguments(parser, dataset.generate, "client")
    _add_arguments(parser, generate, "origin", "offsets", "allow_empty", "progress", device="cpu", threads=1, memory_limit="4GB")
    parser.add_argument("-n", type=int, metavar="N", default=argparse.SUPPRESS, help="with --what points: number of points of each mesh")
    _add_arguments(parser, sample_points, "padding", "normalize", "threads", "progress", group="points")
    add = partial(parser.add_argument, default=argparse.SUPPRESS)
    add("--recipe", choices=get_args(RecipeName), help="points: those of a network, in its files")
    add("--pyramid", type=int, metavar="N", help="number of coarser levels in each .npz, each of half the resolution (0)")
    _add_run(parser)


_PACK = """Packs the results of a data set into shards of many samples: tars as WebDataset reads them, or Zarr arrays.
It may be stopped and run again at any time: a second run writes the shards that are missing or have changed."""


def _add_pack(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="FOLDER", help="folder of the results")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="folder of the shards, or its URL")
    parser.add_argument("--what", choices=["field", "points"], default="field", help="what is packed (field)")
    parser.add_argument("--samples", type=int, default=1000, metavar="N", help="results in a shard (1000)")
    parser.add_argument("--format", choices=get_args(dataset.PackFormat), default="tar", help="format of the shards (tar)")


def _pack(folder: str, output: str, **options: Any) -> int:
    packed = dataset.pack(folder, output, **options)
    with _stdout_errors():
        print(f"{len(packed.meshes)} results in {packed.shards} shards, {packed.new} of them new")
    return 0


_FIELD = """Makes the signed distance field of a mesh, of any size, as an OME-Zarr store.
It may be stopped and run again at any time: a second run makes the shards that are missing."""


def _add_field(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("mesh", metavar="MESH", help="file of the mesh")
    parser.add_argument("-o", "--output", required=True, metavar="OUT.zarr", help="folder of the store")
    _add_arguments(parser, zarr.generate, "sign", "client", "progress")
    parser.add_argument("--unsigned", dest="sign", action="store_false", default=argparse.SUPPRESS, help="distances without a sign")
    _add_run(parser)


def _add_arguments(
    parser: argparse.ArgumentParser, function: Callable[..., object], *left_out: str, group: str = "", **defaults: object
) -> None:
    """Adds the keyword arguments of a function as options. Their help begins its docstring's texts."""
    hints, texts = get_type_hints(function), inspect.getdoc(function) or ""
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is not parameter.KEYWORD_ONLY or name in left_out:
            continue
        found = re.search(rf"^    {name}: (.*(?:\n        .*)*)", texts, re.MULTILINE)
        text = re.sub(r"\s+", " ", found[1]) if found else ""
        default = defaults.get(name, parameter.default)
        parser.add_argument(
            f"--{name.replace('_', '-')}",
            default=argparse.SUPPRESS,
            help=(f"{group}: " if group else "") + _help(text, default),
            **(_FORMS.get(name) or _form(hints[name])),
        )


def _help(text: str, default: object) -> str:
    """Returns the first sentence of an argument's text, as help has it."""
    sentence = re.split(r"; None = |\. |\.$", text.replace("``", "").replace('"', ""))[0].replace("Whether to ", "")
    sentence = sentence[:1].lower() + sentence[1:].replace("if it is None", "if it is not given")
    if default not in (None, False):
        sentence += f" ({' '.join(map(str, default)) if isinstance(default, tuple) else default})"
    return sentence.replace("%", "%%")


def _form(hint: Any) -> dict[str, Any]:
    """Returns how argparse reads a value of a type."""
    if get_origin(hint) is Literal:
        return {"choices": get_args(hint)}
    if hint is bool:
        return {"action": "store_true"}
    return {"type": next(each for each in (int, float, str) if each in (hint, *get_args(hint)))}


def _add_run(parser: argparse.ArgumentParser) -> None:
    """Adds what all commands have that may run on a cluster."""
    parser.add_argument(
        "--progress",
        choices=["plain", "json", "off"],
        help="progress on stderr: a line a minute, or an object a line (a moving line on a terminal, else a line a minute)",
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, as tcp://host:8786, for its cluster")


def _bytes(text: str) -> int:
    """Returns a size in bytes, as the program raymap reads it."""
    if not (match := re.fullmatch(r"((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?) ?(?:([KMGT])I?)?B?", text, re.IGNORECASE)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size; give one as 500MB or 4GB")
    return int(float(match[1]) * 1024 ** " KMGT".index((match[2] or " ").upper()))


# Arguments that the command line gives in another way than their types say.
_FORMS: dict[str, dict[str, Any]] = {
    "arrays": {"nargs": "+", "choices": sorted({*get_args(FieldArray)} - {"distance"})},
    "bounds": {"type": float, "nargs": 6, "metavar": tuple("xyzXYZ")},
    "band": {"type": float},
    "memory_limit": {"type": _bytes, "metavar": "SIZE"},
    "normalize": {"nargs": "?", "const": "sphere", "choices": get_args(Normalization)},
    "shape": {"type": int, "nargs": 3, "metavar": ("NX", "NY", "NZ")},
    "sigma": {"type": float, "nargs": "+"},
    "table": {"metavar": "FILE.parquet"},
    "unit": {"choices": zarr.UNITS, "metavar": "UNIT"},
}


def _dataset(meshes: list[str], output: str, scheduler: str | None, progress: str | None, **options: Any) -> int:
    options["progress"] = _progress_of(progress)
    _join_bounds(options)
    with _client(scheduler) as client:
        given = meshes[0] if len(meshes) == 1 else meshes
        summary = dataset.generate(given, output, client=client, **options)
    if options.get("dry_run"):
        with _stdout_errors():
            print(f"{len(summary.done)} done, {len(summary.quarantined)} quarantined; {len(summary.new)} to make")
        return 0
    with _stdout_errors():
        print(
            f"{len(summary.done)} done, {len(summary.quarantined)} quarantined, {len(summary.unfinished)} unfinished; "
            f"{len(summary.new)} of them new, in {summary.seconds:.1f} s"
        )
        print(f"See {printable(readable(page_paths(Path(output), options.get('what', 'field'))[1]))}")
    return _UNFINISHED if summary.unfinished else 0


def _field(mesh: str, output: str, scheduler: str | None, progress: str | None, **options: Any) -> int:
    options["progress"] = _progress_of(progress)
    _join_bounds(options)
    with _client(scheduler) as client:
        if client is not None and "dashboard" in client.scheduler_info()["services"]:
            print(f"raymap: dashboard: {printable(client.dashboard_link)}", file=sys.stderr)
        summary = zarr.generate(mesh, output, client=client, **options)
    name = printable(readable(output))
    with _stdout_errors():
        if summary.new == 0:
            print(f"{name} was finished before: {summary.shards} shards")
        else:
            print(
                f"{name}: {summary.shards} shards, {summary.new} of them new, {summary.outside} of them all outside and "
                f"without a file, in {summary.seconds:.1f} s"
            )
    return 0


def _join_bounds(options: dict[str, Any]) -> None:
    """Turns six numbers into two corners."""
    if "bounds" in options:
        options["bounds"] = options["bounds"][:3], options["bounds"][3:]


_COMMANDS: dict[str, Callable[..., int]] = {"dataset": _dataset, "field": _field, "pack": _pack}


def _progress_of(given: str | None) -> Any:
    return {None: True, "off": None}.get(given, given)


def _client(scheduler: str | None) -> Any:
    if scheduler is None:
        return nullcontext()
    try:
        distributed = importlib.import_module("distributed")
    except ImportError:
        raise UsageError("--scheduler needs Dask: pip install 'raymap[dask]'") from None
    logging.disable()  # Errors of ours tell what matters of Dask's log.
    try:
        return distributed.Client(scheduler)
    except (OSError, ValueError) as error:
        raise UsageError(f"--scheduler {scheduler}: {error}") from error


if __name__ == "__main__":
    sys.exit(main())
