"""Prints markdown tables of the machine's limits and of every stage against its floor, from stages_bench's JSON."""

import json
import sys


def main():
    runs = json.load(sys.stdin)["benchmarks"]
    machine = {run["name"]: run for run in runs if run["name"].startswith("machine/")}
    stages = [run for run in runs if not run["name"].startswith("machine/")]
    print("| limit | rate |\n|---|---|")
    for name, run in machine.items():
        what, threads = name.removeprefix("machine/").removesuffix("/real_time").split("/")
        rate = (f"{1e-9 * run['bytes_per_second']:.1f} GB/s" if "bytes_per_second" in run
                else f"{1e9 / run['items_per_second']:.2f} ns each")
        print(f"| {what.replace('_', ' ')}, {threads} thread{'s' * (threads != '1')} | {rate} |")
    copy = machine["machine/copy/2/real_time"]["bytes_per_second"]
    print("\n| stage | mesh | resolution | MB at least | floor ms | wall ms | CPU ms | wall / floor |")
    print("|---|---|---|---|---|---|---|---|")
    for run in stages:
        stage, mesh, resolution = run["name"].split("/")[:3]
        wall, cpu = run["real_time"], run["cpu_time"]
        cells = ["", "", f"{wall:.2f}", f"{cpu:.2f}", ""]
        if "bytes_per_second" in run:
            moved = run["bytes_per_second"] * 1e-3 * wall
            floor = 1e3 * moved / copy
            cells = [f"{1e-6 * moved:.1f}", f"{floor:.2f}", *cells[2:4], f"{wall / floor:.1f}"]
        print("| " + " | ".join([stage, mesh, resolution, *cells]) + " |")


if __name__ == "__main__":
    main()
