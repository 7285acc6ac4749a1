"""Runs gpu_bench for all figures of the section "On a GPU" of docs/dev/measurements.md: prints tables, draws two charts."""

import argparse
import math
import os
import pathlib
import statistics
import sys

import charts
from gpu_program import SETTINGS, Bench

EXTENSIONS = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3mf", ".fbx", ".dae"}

# Most milliseconds allowed on an NVIDIA H200, by setting, whether the mesh is `million`, and resolution.
AIMS = {
    ("exact+harmonic", False): {50: 0.5, 128: 1.5, 256: 3, 512: 12},
    ("cell+rays", False): {50: 0.15, 128: 0.3, 256: 1, 512: 6},
    ("exact+harmonic", True): {256: 8},
    ("cell+rays", True): {256: 2},
}
SOLVE_AIM = {256: 1.0}  # Milliseconds that the harmonic solve may add on a broken mesh.
ON_THE_BUS = ("begin", "read_back")  # Stages that the totals leave out.
BYTES_A_SAMPLE = 24
BYTES_A_TRIANGLE = 200


def table(head, rows):
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in (head, *rows)]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]]) + "\n"


def each(meshes, resolutions):
    return [(mesh, setting, n) for mesh in meshes for setting in SETTINGS for n in resolutions]


def table_of_totals(bench, meshes, resolutions):
    rows = []
    for mesh, setting, n in each(meshes, resolutions):
        answer = bench.run("vulkan", mesh, n, setting)
        if "error" in answer:
            rows.append([mesh, setting, n, answer["error"], *[""] * 9])
            continue
        floor = sum(bench.floor(stage, answer) for stage in answer["stages"])
        ms, size = answer["ms"], answer["bytes"] / answer["samples"]
        idle = ms - sum(took for stage, took in answer["stages"].items() if stage not in ON_THE_BUS)
        allowed = BYTES_A_SAMPLE + BYTES_A_TRIANGLE * answer["triangles"] / answer["samples"]
        aim = AIMS[setting, mesh == "million"].get(n)
        rows.append([mesh, setting, n, f"{ms:.3f}", bench.verdict(ms, aim), f"{floor:.3f}", f"{ms / floor:.1f}",
                     f"{idle:.3f}", f"{answer['wall_ms']:.2f}", answer["runs"], f"{1e-6 * answer['bytes']:.0f}", f"{size:.1f}",
                     f"{allowed:.1f} {'met' if size <= allowed else 'MISSED'}"])
    return table(["mesh", "setting", "resolution", "ms", "aim", "floor ms", "ms / floor", "idle ms", "wall ms with transfers", "runs",
                  "MB held", "bytes a sample", "at most"], rows)


def table_of_stages(bench, meshes, resolutions):
    rows, excess = [], {}
    for mesh, setting, _ in each(meshes, resolutions[:1]):
        answers = {n: bench.run("vulkan", mesh, n, setting) for n in resolutions}
        answers = {n: answer for n, answer in answers.items() if "error" not in answer}
        for stage in next(iter(answers.values()), {"stages": {}})["stages"]:
            times = (f"{answers[n]['stages'][stage]:.3f}" if n in answers else "–" for n in resolutions)
            cells = [stage, mesh, setting, ", ".join(times)]
            n = 256 if 256 in answers else max(answers)
            floor = bench.floor(stage, answers[n])
            if floor:
                ms = answers[n]["stages"][stage]
                excess[stage, mesh, setting, n] = ms - floor
                cells += [n, f"{1e-6 * bench.moved(stage, answers[n]):.1f}", f"{floor:.3f}", f"{ms / floor:.1f}"]
            rows.append(cells + ["–"] * (8 - len(cells)))
    result = table(["stage", "mesh", "setting", "ms at " + ", ".join(map(str, resolutions)), "at", "MB at least", "floor ms",
                    "ms / floor"], rows)
    worst = sorted(excess.items(), key=lambda item: -item[1])[:5]
    return result + "\nFarthest above their floors: " + "; ".join(
        f"{stage} ({mesh}, {setting}, {n}) by {ms:.3f} ms" for (stage, mesh, setting, n), ms in worst) + ".\n"


def table_of_solves(bench, meshes, resolutions):
    """Tabulates what the harmonic solve adds. Both settings' stages include the six rays."""
    rows = []
    for mesh in meshes:
        for n in resolutions:
            harmonic, rays = (bench.run("vulkan", mesh, n, setting) for setting in SETTINGS)
            if "error" in harmonic or "error" in rays:
                continue
            with_solve, without = (sum(ms for stage, ms in answer["stages"].items() if stage.startswith("winding"))
                                   for answer in (harmonic, rays))
            share, added = harmonic["doubtful_share"], with_solve - without
            rows.append([mesh, n, f"{100 * share:.3f} %", f"{without:.3f}", f"{with_solve:.3f}", f"{added:.3f}",
                         bench.verdict(added, SOLVE_AIM.get(n)) if share else "nothing is solved"])
    return table(["mesh", "resolution", "samples whose rays disagree", "six rays ms", "harmonic ms", "added ms", "aim"], rows)


def table_of_coarse(bench, mesh, coarse, fine):
    rows = []
    for setting in SETTINGS:
        few, many = (bench.run("vulkan", mesh, n, setting) for n in (coarse, fine))
        if "error" not in few and "error" not in many:
            rows.append([mesh, setting, f"{few['ms']:.3f}", f"{many['ms']:.3f}", bench.verdict(few["ms"], many["ms"])])
    return table(["mesh", "setting", f"ms at {coarse}", f"ms at {fine}", f"aim: {coarse} never slower"], rows)


def series_of(bench, cases, x_of):
    """Returns {name: [(x, ms)]} for the device, the CPU and both settings. `cases` are (mesh, resolution)."""
    series = {}
    for device in ("vulkan", "cpu"):
        for setting in SETTINGS:
            answers = [(case, bench.run(device, *case, setting)) for case in cases]
            series[f"{'Vulkan' if device == 'vulkan' else 'CPU'}, {setting}"] = [
                (x_of(case, answer), answer["ms"]) for case, answer in answers if "error" not in answer]
    return series


def runtime_over_meshes(bench, meshes, resolutions, folder):
    """Draws Fig. 8 of Krayer & Müller 2019 and returns its table."""
    shown = {f"{n} samples": {} for n in resolutions}
    for mesh in meshes:  # One mesh after the other, so each is read once.
        if "error" in bench.run("vulkan", mesh, resolutions[0], "exact+harmonic"):
            continue  # Usually the file is no mesh.
        for n in resolutions:
            for name, points in series_of(bench, [(mesh, n)], lambda case, answer: answer["triangles"]).items():
                shown[f"{n} samples"].setdefault(name, []).extend(points)
    charts.draw(folder / "runtime_over_meshes.svg", ("triangles", "milliseconds"), shown)
    rows = [[title, name, len(points), *(f"{of([ms for _, ms in points]):.3f}" for of in (statistics.mean, statistics.median, max))]
            for title, series in shown.items() for name, points in series.items() if points]
    return table(["resolution", "what", "meshes", "mean ms", "median ms", "slowest ms"], rows)


def runtime_over_resolutions(bench, meshes, resolutions, folder):
    """Draws Fig. 9 of Krayer & Müller 2019 and returns its table."""
    for case in each(meshes, resolutions):  # The device first: the CPU may take long.
        bench.run("vulkan", case[0], case[2], case[1])
    shown = {pathlib.Path(mesh).name: series_of(bench, [(mesh, n) for n in resolutions], lambda case, answer: case[1])
             for mesh in meshes}
    charts.draw(folder / "runtime_over_resolutions.svg", ("samples along the longest side", "milliseconds"), shown,
                x_ticks=resolutions, is_line=True)
    rows = [[title, name, *(f"{dict(points)[n]:.3f}" if n in dict(points) else "–" for n in resolutions)]
            for title, series in shown.items() for name, points in series.items()]
    return table(["mesh", "ms of", *resolutions], rows)


def meshes_of(folder, is_quick):
    if not folder:
        return ["sphere", "scan", "holes", "million"][:2 if is_quick else 4]
    files = [file for file in sorted(folder.iterdir()) if file.suffix.lower() in EXTENSIONS]
    files.sort(key=lambda file: file.stat().st_size)
    return [str(file) for file in (files[:24:4] if is_quick else files)]


def small_mesh(bench, meshes, resolution):
    """Returns the mesh that comes closest to a tenth of the scan's triangles."""
    def distance(mesh):
        return abs(bench.run("vulkan", mesh, resolution, "exact+harmonic").get("triangles", math.inf) - 7000)
    return min(meshes, key=distance)


def tables_of(bench, meshes, is_quick, folder):
    """Returns {name: (title, function that makes the table)}."""
    resolutions = (16, 24) if is_quick else (50, 128, 256, 512)
    over_meshes = (16, 24) if is_quick else (50, 100)
    over_resolutions = resolutions if is_quick else (16, 32, 50, 64, 100, 128, 256, 512)
    largest = "scan" if is_quick else "million"
    broken = ("scan", "holes")
    shown = dict.fromkeys((*broken, largest))

    def over_all_resolutions():
        three = dict.fromkeys((small_mesh(bench, meshes, over_meshes[0]), "scan", largest))
        return runtime_over_resolutions(bench, three, over_resolutions, folder)

    return {
        "latencies": ("Steps without work", lambda: bench.print("--latencies")),
        "fields": ("Fields", lambda: table_of_totals(bench, shown, resolutions)),
        "stages": ("Stages", lambda: table_of_stages(bench, shown, resolutions)),
        "solve": ("The harmonic solve", lambda: table_of_solves(bench, ("sphere", *broken), resolutions)),
        "coarse": ("A coarse grid for many triangles",
                   lambda: table_of_coarse(bench, largest, 16, 24 if is_quick else 64)),
        **{f"counted-{mesh}": (f"Counted work: {mesh}", lambda mesh=mesh: bench.print("--count", "--mesh", mesh, "--resolution", *resolutions))
           for mesh in dict.fromkeys(("scan", largest))},
        "meshes": ("Over the meshes", lambda: runtime_over_meshes(bench, meshes, over_meshes, folder)),
        "resolutions": ("Over the resolutions", over_all_resolutions),
    }


def report(bench, tables):
    machine = bench.machine
    yield (f"{machine['device']} ({machine['driver']}), copies {1e-9 * machine['copy_bytes_per_second']:.1f} GB/s; CPU: "
           f"{machine['cpu']}, {machine['threads']} threads. Medians of warm runs by the device's clock, from the mesh on the "
           "device to the field there.\n")
    for title, make in tables:
        yield f"## {title}\n\n{make()}"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the built program `gpu_bench`")
    parser.add_argument("output", type=pathlib.Path, help="the folder for tables.md, runs.jsonl and the charts")
    parser.add_argument("meshes", nargs="?", type=pathlib.Path, help="a folder of meshes to go through")
    parser.add_argument("--device", help="vulkan:K; the best if not given")
    parser.add_argument("--quick", action="store_true", help="small grids and few meshes")
    parser.add_argument("--table", action="append", metavar="NAME", help="make only this table; can be repeated")
    parser.add_argument("--seconds", type=float, help="measure no longer; what is left is marked in the tables")
    arguments = parser.parse_intermixed_args()  # Lets the folder follow options.
    if arguments.meshes:
        if not arguments.meshes.is_dir():
            parser.error(f"{arguments.meshes} is not a folder")
        if not meshes_of(arguments.meshes, arguments.quick):
            parser.error(f"{arguments.meshes} holds no meshes")
    names = tables_of(None, (), arguments.quick, None)
    for name in arguments.table or ():
        if name not in names:
            parser.error(f"there is no table '{name}', only {', '.join(names)}")
    return arguments


def main():
    arguments = parse_arguments()
    if arguments.meshes:
        os.environ["RAYMAP_MESHES"] = str(arguments.meshes)  # The scan may be there.
    meshes = meshes_of(arguments.meshes, arguments.quick)
    arguments.output.mkdir(parents=True, exist_ok=True)
    with open(arguments.output / "runs.jsonl", "w", buffering=1) as log, open(arguments.output / "tables.md", "w") as pages:
        bench = Bench(arguments.program, arguments.device, log, arguments.seconds)
        tables = tables_of(bench, meshes, arguments.quick, arguments.output)
        for part in report(bench, [tables[name] for name in arguments.table or tables]):
            for file in (sys.stdout, pages):
                print(part, file=file, flush=True)
        sys.exit(0 if bench.finish() else 1)


if __name__ == "__main__":
    main()
