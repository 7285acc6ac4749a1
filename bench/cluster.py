#!/usr/bin/env python3
"""Makes a huge field on Dask clusters, kills processes meanwhile, and prints what it cost as Markdown.

Usage: bench/cluster.py MESH OUT [--resolution 4096] [--band 3] [--memory-limit 1GB]

Needs the packages raymap, zarr and distributed. OUT must not exist. Each cluster is a scheduler and workers with one
thread, all of them processes that talk over TCP: first one worker, then two. In a third run, a worker is killed by
SIGKILL at a third of the shards and the scheduler at two thirds, and a new cluster goes on. Fails unless all stores are
equal, file by file, and no worker takes more memory than its limit."""
import argparse
import hashlib
import os
import pathlib
import re
import sys
import threading
import time

import dask.utils
import distributed
import raymap

sys.path.append(str(pathlib.Path(__file__).parents[1] / "python/tests"))
from dask_cluster import Cluster  # noqa: E402


def check(condition, text):
    if not condition:
        sys.exit(f"cluster.py: {text}")


def cpu_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak_megabytes(pid):
    return int(re.search(r"VmHWM:\s*(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text())[1]) * 1024 / 1e6


def hashes(store):
    """Returns a hash of each file. The lines of the log come in any order, and the lock is none of the store."""
    found = {}
    for path in store.rglob("*"):
        if path.is_file() and path.name != ".lock":
            content = path.read_bytes()
            if path.name == ".outside":
                content = b"".join(sorted(content.splitlines(keepends=True)))
            found[str(path.relative_to(store))] = hashlib.sha256(content).hexdigest()
    return found


def identities(store):
    """Returns what changes if a shard is written again."""
    return {p: (p.stat().st_ino, p.stat().st_mtime_ns) for p in store.glob("0/c/*/*/*")}


def generate(arguments, name, cluster, progress=None):
    """Returns what became of a run, and the CPU seconds that each worker had taken before."""
    with distributed.Client(cluster.address) as client:
        client.wait_for_workers(len(cluster.workers))
        before = [cpu_seconds(process.pid) for process in cluster.workers]
        summary = raymap.zarr.generate(
            arguments.mesh, arguments.out / name, resolution=arguments.resolution, band=arguments.band, client=client,
            progress=progress,
        )  # fmt: skip
        return summary, before


def start_cluster(arguments, name, workers):
    return Cluster(arguments.out / (name + ".dask"), workers, arguments.memory_limit)


def run_and_report(arguments, title, name, cluster):
    """Makes the field and prints what it cost. Returns what became of it, and the CPU seconds of each worker."""
    summary, before = generate(arguments, name, cluster)
    pids = [process.pid for process in cluster.workers]
    seconds = [cpu_seconds(pid) - earlier for pid, earlier in zip(pids, before, strict=True)]
    peaks = [peak_megabytes(pid) for pid in pids]
    cpu, peak = (", ".join(f"{value:.0f}" for value in values) for values in (seconds, peaks))
    print(f"| {title} | {summary.seconds:.0f} | {cpu} | {cpu_seconds(cluster.scheduler.pid):.0f} | {peak} |", flush=True)
    print(f"{name}: {summary}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    check(max(peaks) < arguments.limit, f"a worker took more than {arguments.limit} MB")
    return summary, seconds


def undisturbed(arguments, workers):
    name = f"{workers}_workers"
    with start_cluster(arguments, name, workers) as cluster:
        return run_and_report(arguments, f"{workers}", name, cluster)


def killed(arguments):
    """Kills a worker and the scheduler. Returns the part of the shards that was finished by then."""
    shares, answer = [0.0], []

    def run():
        try:
            answer.append(generate(arguments, "killed", cluster, lambda text, share: shares.append(share)))
        except raymap.Error as error:
            answer.append(error)

    def wait_until(share):
        while shares[-1] < share:
            check(thread.is_alive(), f"the run ended early: {answer}")
            time.sleep(0.02)

    with start_cluster(arguments, "lost", 2) as cluster:
        thread = threading.Thread(target=run)
        thread.start()
        wait_until(1 / 3)
        cluster.workers[0].kill()
        wait_until(2 / 3)
        cluster.scheduler.kill()
        thread.join()
    print(f"killed: {answer[0]}", file=sys.stderr)
    check(isinstance(answer[0], raymap.Error), "the lost scheduler was no error")
    return shares[-1]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("mesh")
    parser.add_argument("out", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--resolution", type=int, default=4096)
    parser.add_argument("--band", type=float, default=3.0)
    parser.add_argument("--memory-limit", default="1GB", help="that of each worker, as Dask reads it")
    arguments = parser.parse_args()
    arguments.limit = dask.utils.parse_bytes(arguments.memory_limit) / 1e6
    arguments.out.mkdir()
    print("| workers | seconds | CPU s of each worker | of the scheduler | most MB of each worker |\n|---|---|---|---|---|")
    (one, alone), (two, both) = (undisturbed(arguments, workers) for workers in (1, 2))
    expected = hashes(arguments.out / "1_workers")
    check(hashes(arguments.out / "2_workers") == expected, "two workers made another store than one")
    share = killed(arguments)
    before = identities(arguments.out / "killed")
    with start_cluster(arguments, "resumed", 2) as cluster:
        rest, _ = run_and_report(arguments, "2, resumed", "killed", cluster)
        nothing, _ = generate(arguments, "killed", cluster)
    after = identities(arguments.out / "killed")
    check({path: after[path] for path in before} == before, "a shard was made twice")
    check(hashes(arguments.out / "killed") == expected, "the store with the kills differs from the others")
    check(nothing.new == 0, "the last run made something")
    print(f"""
{one.shards} shards, {one.outside} of them outside and without a file. Two workers are {one.seconds / two.seconds:.2f}
times as fast as one by the clock, and {sum(alone) / max(both):.2f} times by the CPU time of the busier one. When the
scheduler was killed, {share:.0%} of the shards were finished; {rest.new} were left for the next run. All
{len(expected)} files are equal.""")


if __name__ == "__main__":
    main()
