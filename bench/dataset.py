#!/usr/bin/env python3
"""Makes the fields of a folder of meshes on Dask clusters, kills processes meanwhile, and prints rates as Markdown.

Usage: bench/dataset.py FOLDER OUT [--resolution 64] [--runs 3]

Needs the packages raymap and distributed. OUT must not exist. Each cluster is a scheduler and workers with one thread,
all of them processes that talk over TCP. Fails unless all results equal those of a serial run, bit for bit."""
import argparse
import os
import pathlib
import statistics
import sys
import threading
import time

import distributed
import raymap

sys.path.append(str(pathlib.Path(__file__).parents[1] / "python/tests"))
from dask_cluster import Cluster  # noqa: E402


def contents(folder):
    """Returns all files except for logs, which hold line numbers of the program."""
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file() and p.name != "log.txt"}


def identities(folder):
    """Returns what changes if a marker is written again."""
    return {p: (p.stat().st_ino, p.stat().st_mtime_ns) for p in folder.rglob("*.json")}


def check(condition, text):
    if not condition:
        sys.exit(f"dataset.py: {text}")


def options(arguments):
    return {"resolution": arguments.resolution}


def on_cluster(arguments, name, workers):
    """Returns what became of a run. Its seconds do not count the start of the cluster."""
    with Cluster(arguments.out / (name + ".dask"), workers) as cluster, distributed.Client(cluster.address) as client:
        client.wait_for_workers(workers)
        summary = raymap.dataset.generate(arguments.folder, arguments.out / name, **options(arguments), client=client)
    return summary


def rates(arguments, expected):
    seconds = {1: [], 2: []}
    for k in range(arguments.runs):
        for workers in seconds:
            name = f"dask_{workers}_{k}"
            summary = on_cluster(arguments, name, workers)
            check(contents(arguments.out / name) == expected, f"{name} differs from the serial run")
            seconds[workers].append(summary.seconds)
            print(f"{name}: {summary}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    return {workers: statistics.median(times) for workers, times in seconds.items()}


def with_kills(arguments, expected, count):
    """Kills a worker at a third of the meshes and the scheduler at two thirds; runs again.

    Returns the numbers of meshes that were finished by then and later, and the seconds of a third run."""
    out = arguments.out / "killed"
    answer = []

    def run(address):
        with distributed.Client(address) as client:
            try:
                answer.append(raymap.dataset.generate(arguments.folder, out, **options(arguments), client=client))
            except raymap.Error as error:
                answer.append(error)

    def wait_until(finished):
        while len(identities(out)) < finished:
            check(thread.is_alive(), f"the run ended early: {answer}")
            time.sleep(0.02)

    with Cluster(arguments.out / "lost.dask", 2) as cluster:
        thread = threading.Thread(target=run, args=(cluster.address,))
        thread.start()
        wait_until(count // 3)
        cluster.workers[0].kill()
        wait_until(2 * count // 3)
        cluster.scheduler.kill()
        thread.join()
    print(f"killed: {answer[0]}", file=sys.stderr)
    check(isinstance(answer[0], raymap.Error), "the lost scheduler was no error")
    before = identities(out)
    second = on_cluster(arguments, "killed", 2)
    check({p: i for p, i in identities(out).items() if p in before} == before, "something was made twice")
    check(len(second.new) == count - len(before), "the second run made another number of meshes")
    check(contents(out) == expected, "results with kills differ from the serial run")
    third = raymap.dataset.generate(arguments.folder, out, **options(arguments))
    check(not third.new, "the third run made something")
    return len(before), len(second.new), third.seconds


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    arguments.out.mkdir()
    serial = raymap.dataset.generate(arguments.folder, arguments.out / "serial", **options(arguments), workers=1)
    expected = contents(arguments.out / "serial")
    count = len(serial.new)
    print(f"serial: {serial}", file=sys.stderr)
    finished, rest, nothing = with_kills(arguments, expected, count)
    seconds = rates(arguments, expected)
    print("| workers | meshes per second | seconds |\n|---|---|---|")
    for workers, time_taken in seconds.items():
        print(f"| {workers} | {count / time_taken:.1f} | {time_taken:.1f} |")
    print(f"""
{len(serial.done)} done, {len(serial.quarantined)} quarantined. Two workers take {seconds[2] / seconds[1]:.2f} of the
time of one. With the kills: {finished} finished, then {rest}, then none again in {nothing:.1f} s.""")


if __name__ == "__main__":
    main()
