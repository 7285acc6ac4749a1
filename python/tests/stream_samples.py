"""Prints a hash of each epoch of raymap.torch.SurfaceSamples, for several numbers of workers. test_shards.py runs it."""

from __future__ import annotations

import hashlib

import raymap.torch
import torch


def epoch_hash(workers: int, context: str | None, epoch: int) -> str:
    samples = raymap.torch.SurfaceSamples(
        ["ball.ply", "tetrahedron.ply"], blocks=3, block=50, arrays=("distance", "occupancy"), surface=0.2, near=0.5
    )
    samples.set_epoch(epoch)
    loader = torch.utils.data.DataLoader(samples, batch_size=None, num_workers=workers, multiprocessing_context=context)
    found = hashlib.sha256()
    for block in loader:
        found.update(f"{block['mesh']} {block['points'].tolist()} {block['distance'].tolist()}".encode())
    return found.hexdigest()


if __name__ == "__main__":
    for workers, context, epochs in ((0, None, 2), (2, "fork", 2), (4, "fork", 1), (1, "spawn", 1)):
        print(*(epoch_hash(workers, context, epoch) for epoch in range(epochs)), flush=True)
