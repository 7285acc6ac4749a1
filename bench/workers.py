"""Fields made by Dask clusters whose processes are killed meanwhile: of a folder of meshes, and one that is huge.

A cluster is a scheduler and workers with one thread, all of them processes that talk over TCP. Needs the package
distributed. A table fails unless all results are equal, file by file, and nothing is made twice.
"""

import hashlib
import os
import pathlib
import re
import statistics
import sys
import threading
import time

from harness import head, line, table

sys.path.append(str(pathlib.Path(__file__).parents[1] / "python/tests"))


def check(condition, text):
    if not condition:
        sys.exit(f"workers: {text}")


def hashes(folder):
    """Returns a hash of each file. The lines of .outside come in any order; locks and logs are no results."""
    found = {}
    for path in folder.rglob("*"):
        if path.is_file() and path.name not in (".lock", "log.txt"):
            content = path.read_bytes()
            content = b"".join(sorted(content.splitlines(keepends=True))) if path.name == ".outside" else content
            found[path.relative_to(folder)] = hashlib.sha256(content).hexdigest()
    return found


def identities(folder, pattern="**/*.json"):
    """Returns what changes if a result is written again."""
    return {p: (p.stat().st_ino, p.stat().st_mtime_ns) for p in folder.glob(pattern)}


def cpu_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak_megabytes(pid):
    return int(re.search(r"VmHWM:\s*(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text())[1]) * 1024 / 1e6


def on_cluster(make, cluster, out):
    """Returns what became of a run on a cluster, and the CPU seconds of each worker."""
    import distributed

    with distributed.Client(cluster.address) as client:
        client.wait_for_workers(len(cluster.workers))
        before = [cpu_seconds(process.pid) for process in cluster.workers]
        summary = make(out, client)
        after = [cpu_seconds(process.pid) for process in cluster.workers]
    print(f"{out.name}: {summary}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    return summary, [b - a for a, b in zip(before, after, strict=True)]


def kill_meanwhile(make, cluster, out, share):
    """Kills a worker once `share()` has passed a third, and the scheduler at two thirds."""
    import raymap

    answer = []

    def run():
        try:
            answer.append(on_cluster(make, cluster, out))
        except raymap.Error as error:
            answer.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    for least, process in ((1 / 3, cluster.workers[0]), (2 / 3, cluster.scheduler)):
        while share() < least:
            check(thread.is_alive(), f"the run ended early: {answer}")
            time.sleep(0.02)
        process.kill()
    thread.join()
    check(isinstance(answer[0], raymap.Error), "the lost scheduler was no error")


@table
def dataset(folder, out, resolution=64, runs=3):
    """Meshes per second on one and two workers, and what is left after kills: docs/performance.md. OUT must not exist."""
    import raymap
    from dask_cluster import Cluster

    make = lambda to, client=None, **options: raymap.dataset.generate(folder, to, resolution=resolution, client=client, **options)  # noqa: E731
    out.mkdir()
    serial = make(out / "serial", workers=1)
    expected, count, killed = hashes(out / "serial"), len(serial.new), out / "killed"
    with Cluster(out / "lost.dask", 2) as cluster:
        kill_meanwhile(make, cluster, killed, lambda: len(identities(killed)) / count)
    before = identities(killed)
    with Cluster(out / "next.dask", 2) as cluster:
        rest, _ = on_cluster(make, cluster, killed)
    check({p: i for p, i in identities(killed).items() if p in before} == before, "something was made twice")
    check(hashes(killed) == expected, "results with kills differ from the serial run")
    third = make(killed)
    check(len(rest.new) == count - len(before) and not third.new, "a run made another number of meshes")
    head("workers", "meshes per second", "seconds")
    for workers in (1, 2):
        seconds = []
        for k in range(runs):
            to = out / f"dask_{workers}_{k}"
            with Cluster(out / f"{to.name}.dask", workers) as cluster:
                seconds.append(on_cluster(make, cluster, to)[0].seconds)
            check(hashes(to) == expected, f"{to.name} differs from the serial run")
        line(workers, f"{count / statistics.median(seconds):.1f}", f"{statistics.median(seconds):.1f}")
    print(f"\n{len(serial.done)} done, {len(serial.quarantined)} quarantined. With the kills: {len(before)} finished, then "
          f"{len(rest.new)}, then none again in {third.seconds:.1f} s.")  # fmt: skip


@table
def cluster(mesh, out, resolution=4096, band=3.0, memory_limit="1GB"):
    """Costs of a huge field on one and two workers, and after kills: docs/performance.md. OUT must not exist."""
    import dask.utils
    import raymap
    from dask_cluster import Cluster

    shards, shares, limit = "0/c/*/*/*", [0.0], dask.utils.parse_bytes(memory_limit) / 1e6

    def make(to, client):
        shares[:] = [0.0]
        return raymap.zarr.generate(mesh, to, resolution=resolution, band=band, client=client,
                                    progress=lambda text, share: shares.append(share))  # fmt: skip

    def run(title, workers, to):
        with Cluster(out / f"{title}.dask", workers, memory_limit) as cluster:
            summary, seconds = on_cluster(make, cluster, to)
            peaks = [peak_megabytes(process.pid) for process in cluster.workers]
            each = [", ".join(f"{value:.0f}" for value in values) for values in (seconds, peaks)]
            line(title, f"{summary.seconds:.0f}", each[0], f"{cpu_seconds(cluster.scheduler.pid):.0f}", each[1])
            check(max(peaks) < limit, f"a worker took more than {limit} MB")
        return summary

    out.mkdir()
    head("workers", "seconds", "CPU s of each worker", "of the scheduler", "most MB of each worker")
    one, two = (run(f"{workers}", workers, out / f"{workers}_workers") for workers in (1, 2))
    expected, killed = hashes(out / "1_workers"), out / "killed"
    check(hashes(out / "2_workers") == expected, "two workers made another store than one")
    shares[:] = [0.0]
    with Cluster(out / "lost.dask", 2, memory_limit) as lost:
        kill_meanwhile(make, lost, killed, lambda: shares[-1])
    finished, before = shares[-1], identities(killed, shards)
    rest = run("2, the rest after the kills", 2, killed)
    check({p: i for p, i in identities(killed, shards).items() if p in before} == before, "a shard was made twice")
    check(hashes(killed) == expected, "the store with the kills differs from the others")
    print(f"\n{one.shards} shards, {one.outside} of them outside and without a file. Two workers are {one.seconds / two.seconds:.2f} times "
          f"as fast as one by the clock. At the loss of the scheduler {finished:.0%} of the shards were finished; {rest.new} were left.")
