"""The commands that the program raymap lacks: ``python -m raymap dataset``, ``pack`` and ``field``."""

from __future__ import annotations

import argparse
import importlib
import logging
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, get_args

from . import dataset, zarr
from ._errors import Error, FileError, UsageError, code_of
from ._frames import Normalization
from ._records import DistanceMode, Orientation, Sampling, SignMode
from ._samples import Region
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
    add = partial(parser.add_argument, default=argparse.SUPPRESS)
    add("--what", choices=["field", "points"], help="what is made of each mesh (field)")
    add("--format", choices=dataset.FORMATS, help="format of the fields (npz)")
    add("--table", metavar="FILE.parquet", help="write the table there, too, with types; needs pyarrow")
    _add_grid(add)
    add("--shape", type=int, nargs=3, metavar=("NX", "NY", "NZ"), help="number of samples of every field")
    add("--cube", action="store_true", help="as many samples along every side: fields that can be stacked")
    add("--distance", choices=get_args(DistanceMode), help="source of the magnitude (exact)")
    add("--sign", choices=get_args(SignMode), help="method that decides inside and outside (harmonic)")
    add("--passes", type=int, metavar="P", help="passes of --sign paths, or steps of evolution (5)")
    add("--sampling", choices=get_args(Sampling), help="offset points of --sign paths and evolution (spread)")
    add("--threshold", type=float, metavar="W", help="a sample is inside if its winding number exceeds this (0.5)")
    add("--invert", action="store_true", help="inside is positive instead of negative")
    add("--close-holes", action="store_true", help="distances count the surface that is missing in holes")
    add("--thickness", type=float, metavar="T", help="thickness of a wall around the surface, in place of the sign")
    add("--band", type=float, metavar="B", help="clamp distances at so many samples")
    add("--sparse", action="store_true", help="narrow bands, which grow with the surface, as vdb or nvdb")
    add("--truncation", type=float, metavar="D", help="clamp distances at this length, in place of --band")
    add("--pyramid", type=int, metavar="N", help="number of coarser levels in each .npz, each of half the resolution (0)")
    add("--arrays", nargs="+", choices=["winding", "confidence", "triangle"], help="arrays beside the distance")
    add("-n", type=int, metavar="N", help="with --what points: number of points of each mesh")
    add("--near", type=float, metavar="SHARE", help="points: share near the surface (0.94)")
    add("--sigma", type=float, nargs="+", metavar="S", help="points: their standard deviations (0.0025 0.00025)")
    add("--surface", type=float, metavar="SHARE", help="points: share on the surface (0)")
    add("--region", choices=get_args(Region), help="points: where those lie that are not near the surface (sphere)")
    add("--recipe", choices=get_args(RecipeName), help="points: those of a network, in its files")
    add("--seed", type=int, metavar="K", help="points: another number gives other points (0)")
    add(
        "--normalize",
        nargs="?",
        const="sphere",
        choices=get_args(Normalization),
        help="move every mesh to 0, and scale its bounding sphere to radius 1 (sphere), or its longest side to 2 (cube) or 1 (unit)",
    )
    add("--device", metavar="ID", help="device that computes (cpu)")
    add("--threads", type=int, metavar="N", help="threads for each mesh (1)")
    add("--workers", type=int, metavar="N", help="meshes at a time on this machine (as many as processors)")
    add("--memory-limit", type=_bytes, metavar="SIZE", help="most memory for a mesh, as 500MB or 4GB (4GB)")
    add("--time-limit", type=float, metavar="S", help="most seconds for a mesh (600)")
    add("--retry", action="store_true", help="try quarantined meshes again although nothing has changed")
    add("--dry-run", action="store_true", help="write nothing; say how many meshes there are to make")
    add("--pages", action="store_true", help="write a page beside each field that shows it in a browser")
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
    add = partial(parser.add_argument, default=argparse.SUPPRESS)
    _add_grid(add)
    add("--band", type=float, metavar="B", help="clamp distances at so many samples, which makes the store sparse")
    add("--unsigned", dest="sign", action="store_false", help="distances without a sign")
    add("--chunks", type=int, metavar="N", help="samples along the side of a chunk (64)")
    add("--shards", type=int, metavar="N", help="samples along the side of a shard, a file of many chunks (256)")
    add("--pyramid", type=int, metavar="N", help="number of coarser levels, each of half the resolution (0)")
    add("--unit", choices=zarr.UNITS, metavar="UNIT", help="unit of the mesh's lengths, such as millimeter")
    add("--overwrite", action="store_true", help="remove a store of other options or another mesh in OUT.zarr")
    add("--threads", type=int, metavar="N", help="shards at a time on this machine (as many as processors)")
    add("--memory-limit", type=_bytes, metavar="SIZE", help="most memory on this machine (what is available)")
    _add_run(parser)


def _add_grid(add: Callable[..., object]) -> None:
    """Adds what all commands have that make fields."""
    add("--resolution", type=int, metavar="N", help="samples along the longest side (128)")
    add("--voxel-size", type=float, metavar="H", help="distance between samples, in place of --resolution")
    add("--padding", type=float, metavar="P", help="padding of the bounds, as a share of their longest side (0.1)")
    add("--bounds", type=float, nargs=6, metavar=tuple("xyzXYZ"), help="box to cover, its lowest and highest corner")
    add("--orientation", choices=get_args(Orientation), help="whether faces are reversed (auto)")


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
