"""Prints a hash of each of two epochs of the data sets of raymap.torch, for several workers. test_shards.py runs it.

Each argument is a number of workers, with the way they start: 0, fork:2, spawn:1. The folders "tar" and "zarr" hold
shards. A line has the name of a data set, the argument and the hashes.

Workers that are spawned import PyTorch, which takes seconds. So all streams and epochs share a loader.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable, Iterator
from typing import Any

import raymap.torch
import torch

EPOCHS = 2
SHARDS = ("tar", "zarr")


class Streams(torch.utils.data.IterableDataset):
    """Streams one after the other, with the number of the stream. None fills the turns of workers that have no item left."""

    def __init__(self, streams: list[Any], most: int) -> None:
        self.streams, self.most = streams, most

    def __iter__(self) -> Iterator[tuple[int, dict[str, Any]] | None]:
        worker = torch.utils.data.get_worker_info()
        turns = -(-self.most // (1 if worker is None else worker.num_workers))
        for number, stream in enumerate(self.streams):
            items = list(stream)
            assert len(items) <= turns
            yield from ((number, item) for item in items)
            yield from [None] * (turns - len(items))


def update(found: Any, item: dict[str, Any]) -> None:
    """Adds all bits of an item to a hash."""
    for name, value in item.items():
        content = value.contiguous().numpy().tobytes() if isinstance(value, torch.Tensor) else repr(value).encode()
        found.update(f"{name} {len(content)} ".encode() + content)


def stream_hashes(**loading: Any) -> Iterator[tuple[str, list[str]]]:
    """Yields the name of each stream and the hashes of its epochs."""
    samples = {"blocks": 3, "block": 50, "arrays": ("distance", "occupancy"), "surface": 0.2, "near": 0.5}
    names = ["samples", *SHARDS]
    streams = []
    for epoch in range(EPOCHS):
        streams += [raymap.torch.SurfaceSamples(["ball.ply", "tetrahedron.ply"], **samples)]
        streams += [raymap.torch.ResultStream(place) for place in SHARDS]
        for stream in streams[-len(names) :]:
            stream.set_epoch(epoch)
    found = [hashlib.sha256() for _ in streams]
    for item in torch.utils.data.DataLoader(Streams(streams, most=6), batch_size=None, **loading):
        if item is not None:
            update(found[item[0]], item[1])
    for k, name in enumerate(names):
        yield f"stream:{name}", [each.hexdigest() for each in found[k :: len(names)]]


def dataset_hashes(**loading: Any) -> Iterator[tuple[str, list[str]]]:
    """Yields the name of each data set of shards and the hashes of its epochs, in shuffled batches."""
    data = torch.utils.data.ConcatDataset([raymap.torch.ResultDataset(place) for place in SHARDS])
    # A generator of the loader itself would be used in another way by workers that live longer than an epoch.
    shuffled = torch.utils.data.RandomSampler(data, generator=torch.Generator().manual_seed(1))
    is_parallel = loading["num_workers"] > 0
    loader = torch.utils.data.DataLoader(data, batch_size=3, sampler=shuffled, persistent_workers=is_parallel, **loading)
    yield "dataset", [hash_of(loader) for _ in range(EPOCHS)]


def hash_of(items: Iterable[dict[str, Any]]) -> str:
    found = hashlib.sha256()
    for item in items:
        update(found, item)
    return found.hexdigest()


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        context, workers = argument.split(":") if ":" in argument else (None, argument)
        loading = {"num_workers": int(workers), "multiprocessing_context": context}
        for hashes in (stream_hashes, dataset_hashes):
            for name, epochs in hashes(**loading):
                print(name, argument, *epochs, flush=True)
