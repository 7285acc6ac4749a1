"""The process that makes the results of a data set, one mesh after the other: ``python -m raymap.dataset.child DEVICE``.

It first says what is wrong with the device, and ends if anything is. Then it reads one job a line from stdin, and
writes one reply a line to stdout, both as JSON. All else that is printed goes to stderr, which is the log. It ends with
its parent, or if it has nothing to do for a while.
"""

from __future__ import annotations

import errno
import faulthandler
import json
import math
import os
import queue
import resource
import signal
import socket
import sys
import threading
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .. import _html
from .._errors import (
    DeviceLostError,
    DeviceMemoryError,
    Error,
    FileError,
    MemoryLimitError,
    UnsupportedError,
    UsageError,
    code_of,
)
from .._field import Field, core_of_field, save_as
from .._frames import Frame, frame_arrays
from .._generate import generate
from .._mesh import Mesh, load_mesh, tetrahedron
from .._pyramid import coarser_arrays, generate_pyramid
from .._raymap import write_whole
from .._repair import info
from .._samples import sample_points, save_as_npz
from ..recipes import recipe_of, samples_of
from .files import readable

_IDLE_SECONDS = 60.0
_THUMBNAIL = {"width": 192, "height": 144, "device": "cpu"}


def main() -> None:
    """Does jobs until stdin ends."""
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for ending in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:  # The parent decides; a signal says nothing of a mesh.
        signal.signal(ending, signal.SIG_IGN)
    jobs: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(jobs,), daemon=True).start()
    trouble = _device_trouble(sys.argv[1])
    print(json.dumps(trouble), file=replies)
    own_memory = _memory_in_use()
    while not trouble:
        try:
            job = jobs.get(timeout=_IDLE_SECONDS)
        except queue.Empty:
            return
        print(json.dumps(_answer(json.loads(job), own_memory)), file=replies)


def _receive(jobs: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        jobs.put(line)
    os.killpg(0, signal.SIGKILL)  # The parent has ended, so nobody wants the result. Importers end as well.


def _answer(job: dict[str, Any], own_memory: int) -> dict[str, Any]:
    """Does a job. Returns figures, or what `_explain` returns, or why the result cannot be written."""
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (own_memory + job["memory_limit"], most))
    try:
        figures, write = _make(job)
    except Exception as error:
        traceback.print_exc()
        return _explain(error, job)
    try:
        write()
    except Exception as error:
        if _is_memory(error):  # Another mesh may fit.
            traceback.print_exc()
            return _explain(error, job)
        if not isinstance(error, Error):
            raise
        return {"trouble": code_of(error), "reason": str(error)}  # For example a build without OpenVDB
    return {"figures": figures}


def _explain(error: Exception, job: dict[str, Any]) -> dict[str, Any]:
    """Returns why a mesh failed, whether a fresh process must try again, and whether the machine is at fault.

    If the device fails on any mesh, returns that.
    """
    text = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
    text = text.encode(errors="backslashreplace").decode()  # It may hold a path that is not UTF-8.
    device = job["options"].get("device", "cpu")
    if _is_memory(error):
        is_full = isinstance(error, DeviceMemoryError)
        reason = text if is_full else _memory_reason(error, job)
        return {"reason": reason, "again": True, "is_machine": is_full}
    if isinstance(error, (UnsupportedError, DeviceLostError)) and (trouble := _device_trouble(device)):
        return trouble
    # The file was read before, by the parent. And other meshes may not need the program.
    is_machine = isinstance(error, FileError) or "the program raymap-import" in text
    return {"reason": text, "again": isinstance(error, DeviceLostError), "is_machine": is_machine}


def _device_trouble(device: str) -> dict[str, Any]:
    """Returns why a device cannot make any field at all; nothing if it can. The CPU always can."""
    if device == "cpu":
        return {}
    try:
        generate(tetrahedron(), resolution=8, device=device)
    except (UsageError, UnsupportedError, DeviceLostError) as error:
        return {"trouble": code_of(error), "reason": f"{error} (on the machine {socket.gethostname()})"}
    except MemoryError:
        pass
    return {}


def _is_memory(error: Exception) -> bool:
    no_thread = os.strerror(errno.EAGAIN)  # No thread can start, as its stack does not fit.
    return isinstance(error, (MemoryError, MemoryLimitError)) or no_thread in str(error)


def _memory_reason(error: Exception, job: dict[str, Any]) -> str:
    text = str(error) if isinstance(error, MemoryLimitError) else "needs more memory"
    if count := job["options"].get("n"):  # Resolution, which the error names, is none of points.
        advice = "make fewer, or use a higher limit; raymap.Sampler streams any number"
        text = f"{text.partition(';')[0]}: the mesh and all {count} points are held at once; {advice}"
    return f"{text} (memory_limit is {job['memory_limit']} bytes)"


def _memory_in_use() -> int:
    """Returns the bytes that RLIMIT_DATA counts. They do not include what allocators and threads merely reserve."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmData:"))


def _make(job: dict[str, Any]) -> tuple[dict[str, Any], Callable[[], None]]:
    """Returns the figures of a mesh, and a function that writes its files."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = load_mesh(job["mesh"])
        found = info(mesh)
        write, figures = _MAKERS[job["what"]](mesh, job)
    odd = sorted({(getattr(warning.message, "code", warning.category.__name__), str(warning.message)) for warning in caught})
    found_odd = [{"code": code, "message": message} for code, message in odd]
    return {**figures, "info": found, "warnings": found_odd}, write


def _make_field(mesh: Mesh, job: dict[str, Any]) -> tuple[Callable[[], None], dict[str, Any]]:
    options = {**job["options"], "threads": job["threads"], "memory_limit": job["memory_limit"]}
    if options.pop("sparse"):
        return _make_band(mesh, job, options)
    levels = generate_pyramid(mesh, levels=options.pop("pyramid") + 1, **options)
    field = levels[0]
    picture = _picture(field, job["threads"])
    page = None
    if job["page"] is not None:
        page = field.to_html(title=readable(os.path.basename(job["mesh"])), mesh=mesh, device="cpu", threads=job["threads"])

    # Also that of a mesh which need not move: all files of a data set have the same arrays.
    placement = frame_arrays(Frame(field.centre, field.scale)) if job["options"]["normalize"] else {}

    def write() -> None:
        save_as(field, job["result"], "." + job["format"], {**coarser_arrays(levels), **placement})
        write_whole(job["thumbnail"], picture)
        if page is not None:
            write_whole(job["page"], page.encode())

    return write, {"field": {**_field_figures(field, job), **_dense_figures(field)}}


def _make_band(mesh: Mesh, job: dict[str, Any], options: dict[str, Any]) -> tuple[Callable[[], None], dict[str, Any]]:
    del options["pyramid"]
    band = generate(mesh, sparse=True, **options)
    picture = _picture(band, job["threads"])

    def write() -> None:
        named = f"{job['result']}.{job['format']}"  # The writer knows formats by their extensions.
        core_of_field(band).save(named, "distance")
        os.replace(named, job["result"])
        write_whole(job["thumbnail"], picture)

    return write, {"field": {**_field_figures(band, job), **_band_figures(band)}}


def _picture(field: Field, threads: int) -> bytes:
    return _html.png(field.render(**_THUMBNAIL, threads=threads))  # type: ignore[arg-type]


def _field_figures(field: Field, job: dict[str, Any]) -> dict[str, Any]:
    frame = {"centre": field.centre.tolist(), "scale": field.scale} if job["options"]["normalize"] else {}
    return {"samples": list(field.shape), "origin": field.origin.tolist(), "spacing": field.spacing, **frame}


def _band_figures(band: Field) -> dict[str, Any]:
    in_tiles = int((band.tile_sides.astype(np.int64) ** 3).sum())  # All of these samples are inside.
    deepest = -band.inside if in_tiles else np.inf
    return {
        "distance_min": float(min(band.distance.min(initial=np.inf), deepest)),
        "distance_max": float(band.distance.max(initial=-np.inf)),
        "inside_share": (np.count_nonzero(band.distance < 0) + in_tiles) / math.prod(band.shape),
        "leaves": len(band.origins),
        "active_samples": band.active_count,
    }


def _dense_figures(field: Field) -> dict[str, Any]:
    costs = ("stages", "milliseconds", "bytes")  # They differ between runs.
    found = {name: value for name, value in field.stats.items() if name not in costs}
    return {
        "distance_min": float(field.distance.min()),
        "distance_max": float(field.distance.max()),
        "inside_share": float(np.count_nonzero(field.distance < 0) / field.distance.size),
        **{name: len(value) if isinstance(value, np.ndarray) else value for name, value in found.items()},
    }


def _make_points(mesh: Mesh, job: dict[str, Any]) -> tuple[Callable[[], None], dict[str, Any]]:
    options, recipe = job["options"], None
    if "recipe" in options:
        recipe = recipe_of(options["recipe"])
        samples = samples_of(recipe, mesh, options["n"], options["seed"], job["threads"])
    else:
        samples = sample_points(mesh, **options, threads=job["threads"])
    small = generate(mesh, resolution=48, device="cpu", threads=job["threads"], memory_limit=job["memory_limit"])
    picture = _picture(small, job["threads"])

    def write() -> None:
        (save_as_npz if recipe is None else recipe.write)(samples, job["result"])
        write_whole(job["thumbnail"], picture)

    figures = {
        "points": len(samples.points),
        "points_inside": int(np.count_nonzero(samples.distance < 0)),
        "distance_min": float(samples.distance.min(initial=0.0)),
        "distance_max": float(samples.distance.max(initial=0.0)),
        "centre": samples.centre.tolist(),
        "scale": samples.scale,
    }
    return write, {"points": figures}


_MAKERS = {"field": _make_field, "points": _make_points}

if __name__ == "__main__":
    main()
