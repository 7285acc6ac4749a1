"""Measures how often the sign is wrong on broken meshes and draws pictures of why.

The results are the sections "Winding fields" and "Deficient meshes" of docs/evaluation.md. They redraw figures 7, 10 and
11 of Krayer & Müller 2019 from our own runs.

    evaluate.py RAYMAP FOLDER OUT [--only TEXT]

RAYMAP is the program, FOLDER holds meshes and MESHES.tsv, OUT gets tables (.md) and pictures (.png).
The truth is the exact generalized winding number (libigl's `winding_number`, double precision).
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import igl
import numpy as np
from mesh_table import mesh_rows, tabulate
from PIL import Image, ImageDraw

MODES = ("rays", "paths", "evolution", "harmonic")
SOLID_ANGLES = 4e8  # Budget of one mesh's exact numbers: triangles times samples.
SCANS = (  # Name, file, axis that the slices are across.
    ("bust, scanned, open below", "odedstein__demosthenes-low-res.obj", 0),
    ("body of five parts, open", "geogram__SaraPezzini.obj", 2),
)
CELL = 300  # Width of one picture in a row of pictures, in pixels.


class Case:
    """One mesh and the program's results for it."""

    def __init__(self, raymap, mesh, resolution, folder):
        self.raymap, self.mesh, self.resolution, self.folder = raymap, pathlib.Path(mesh), resolution, folder
        self.runs = {}

    def run(self, mode):
        """Returns winding numbers [i, j, k] and statistics of one sign mode, with the faces as given."""
        if mode not in self.runs:
            self.runs[mode] = self.run_anew(mode)
        return self.runs[mode]

    def run_anew(self, mode):
        out = {name: self.folder / f"{name}" for name in ("d.npy", "w.npy", "s.json")}
        subprocess.run(
            [self.raymap, "generate", self.mesh, "-o", out["d.npy"], "--winding", out["w.npy"], "--stats"]
            + [out["s.json"], "--sign", mode, "--orientation", "keep", "--resolution", str(self.resolution)]
            + ["--device", "cpu"],
            check=True, capture_output=True, text=True)  # fmt: skip
        return np.load(out["w.npy"]), json.loads(out["s.json"].read_text())

    def milliseconds(self, mode):
        """Returns the time from triangles in memory to the finished field, the least of three runs."""
        runs = [self.run(mode), self.run_anew(mode), self.run_anew(mode)]
        return min(stats["stats"]["milliseconds"] for _, stats in runs)

    def grid(self):
        return self.run("harmonic")[1]["grid"]

    def positions(self, index):
        grid = self.grid()
        return np.asarray(grid["origin"]) + grid["spacing"] * index


def read_mesh(args, path, folder):
    """Returns vertices and triangles as the program reads them."""
    ply = folder / "as_read.ply"
    subprocess.run([args.raymap, "convert", path, ply], check=True, capture_output=True, text=True)
    return igl.read_triangle_mesh(str(ply))


def write_off(path, vertices, triangles):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
        np.savetxt(file, vertices, "%.9g")
        np.savetxt(file, np.column_stack([np.full(len(triangles), 3), triangles]), "%d")


def shatter(vertices, triangles, reach, where=None, seed=1):
    """Gives every face corners of its own and moves those of all faces (or those `where`) by up to `reach`."""
    random = np.random.default_rng(seed)
    chosen = np.ones(len(triangles), bool) if where is None else where
    corners = vertices[triangles]
    move = random.normal(size=corners.shape)
    move *= reach * random.random(corners.shape[:2] + (1,)) / np.linalg.norm(move, axis=2, keepdims=True)
    corners[chosen] += move[chosen]
    return corners.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def inside(w):
    return np.abs(w) > 0.5


def exact_numbers(vertices, triangles, case, budget=SOLID_ANGLES):
    """Returns indices [n, 3] of random samples, as many as the budget allows, and their exact winding numbers."""
    dims = np.asarray(case.grid()["dims"])
    total = int(np.prod(dims))
    count = min(total, max(2000, int(budget / len(triangles))))
    flat = np.random.default_rng(0).permutation(total)[:count] if count < total else np.arange(total)
    index = np.stack(np.unravel_index(flat, dims), axis=1)
    return index, igl.winding_number(vertices, triangles, case.positions(index))


def share_wrong(w, index, exact):
    return 100.0 * np.mean(inside(w[tuple(index.T)]) != inside(exact))


# Pictures.


def heat(values):
    """Returns the colours of |w|, from dark at 0 to bright at 1.5. `contour` adds a white line at 0.5."""
    stops = np.array([0, 0.25, 0.5, 0.75, 1.0, 1.5])
    colours = np.array([[12, 14, 40], [52, 60, 140], [120, 90, 170], [235, 130, 90], [250, 215, 120], [255, 255, 240]])
    v = np.clip(np.abs(values), 0, 1.5)
    return np.stack([np.interp(v, stops, colours[:, c]) for c in range(3)], axis=-1).astype(np.uint8)


def contour(picture, values):
    """Draws a white line where a sample is inside and its neighbour is not."""
    now = inside(values)
    edge = np.zeros_like(now)
    edge[1:] |= now[1:] != now[:-1]
    edge[:, 1:] |= now[:, 1:] != now[:, :-1]
    picture[edge] = 255
    return picture


def differences(ours, theirs):
    """Draws Fig. 11: grey where both agree, red where only ours is inside, green where only theirs is."""
    a, b = inside(ours), inside(theirs)
    picture = np.full(a.shape + (3,), 235, np.uint8)
    picture[a & b] = 150
    picture[a & ~b] = (210, 30, 40)
    picture[~a & b] = (30, 160, 60)
    return picture


def upright(image):
    """Returns an image [right, up] as rows from the top."""
    return Image.fromarray(np.ascontiguousarray(np.swapaxes(image, 0, 1)[::-1]))


def sheet(rows, labels, path):
    """Saves rows of pictures [right, up, 3], each row of one size, with a line of text under each picture."""
    line = 18
    heights = [int((CELL - 6) * row[0].shape[1] / row[0].shape[0]) for row in rows]
    canvas = Image.new("RGB", (CELL * len(rows[0]), sum(heights) + line * len(rows)), "white")
    draw = ImageDraw.Draw(canvas)
    top = 0
    for row, row_labels, height in zip(rows, labels, heights):
        for c, (picture, label) in enumerate(zip(row, row_labels)):
            canvas.paste(upright(picture).resize((CELL - 6, height), Image.NEAREST), (CELL * c, top))
            draw.text((CELL * c + 4, top + height + 2), label, fill="black")
        top += height + line
    canvas.save(path, optimize=True)


# Sections.


def slice_positions(case, axis, at):
    dims = np.asarray(case.grid()["dims"])
    others = [a for a in range(3) if a != axis]
    index = np.zeros((dims[others[0]], dims[others[1]], 3), int)
    index[..., axis] = at
    index[..., others[0]], index[..., others[1]] = np.meshgrid(*(np.arange(dims[a]) for a in others), indexing="ij")
    return index, index.reshape(-1, 3)


def take(field, index):
    return field[tuple(np.moveaxis(index, -1, 0))]


def winding_fields(args, folder):
    """Redraws Fig. 7, 10 and 11 with a bunny (clean, broken in one region, shattered) and open scans with inner parts."""
    vertices, triangles = read_mesh(args, args.folder / "libigl__bunny.off", folder)
    side = np.ptp(vertices, axis=0).max()
    middles = vertices[triangles].mean(axis=1)
    near = np.linalg.norm(middles - middles[np.argmax(middles[:, 1])], axis=1) < 0.3 * side
    variants = {
        "bunny": (vertices, triangles),
        "bunny, one region broken": shatter(vertices, triangles, 0.03 * side, near),
        "bunny, shattered": shatter(vertices, triangles, 0.03 * side),
    }
    cases = {}
    for number, (name, mesh) in enumerate(variants.items()):
        write_off(folder / f"{number}.off", *mesh)
        cases[name] = folder / f"{number}.off", 2, mesh
    for name, file, axis in SCANS:
        cases[name] = args.folder / file, axis, read_mesh(args, args.folder / file, folder)
    lines = ["| | " + " | ".join(MODES) + " | harmonic, from libigl's fast one |", "|---|---|---|---|---|---|"]
    fields, fields_labels, signs, signs_labels = [], [], [], []
    for name, (path, axis, (v, t)) in cases.items():
        case = Case(args.raymap, path, 100, folder)
        w = {mode: case.run(mode)[0] for mode in MODES}
        index, exact = exact_numbers(v, t, case, 8 * SOLID_ANGLES)
        everywhere = np.indices(w["harmonic"].shape).reshape(3, -1).T
        fast = igl.fast_winding_number(v, t, case.positions(everywhere)).reshape(w["harmonic"].shape)
        cells = [f"{share_wrong(w[mode], index, exact):.3f} %" for mode in MODES]
        cells.append(f"{100 * np.mean(inside(w['harmonic']) != inside(fast)):.3f} %")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
        # Fig. 7 shows the middle slice, Fig. 11 the slice with most differences, as in the paper.
        plane, flat = slice_positions(case, axis, w["rays"].shape[axis] // 2)
        truth = igl.winding_number(v, t, case.positions(flat)).reshape(plane.shape[:2])
        shown = {"exact": truth, **{mode: take(w[mode], plane) for mode in ("rays", "evolution", "harmonic")}}
        fields.append([contour(heat(values), values) for values in shown.values()])
        fields_labels.append([f"{name}: |w|, {kind}" for kind in shown])
        differ = inside(w["harmonic"]) != inside(fast)
        if not differ.any():
            continue
        most = int(np.argmax(differ.sum(axis=tuple(a for a in range(3) if a != axis))))
        plane, _ = slice_positions(case, axis, most)
        signs.append([differences(take(w[mode], plane), take(fast, plane)) for mode in ("rays", "paths", "harmonic")])
        signs_labels.append([f"{name}: {mode}" for mode in ("rays", "paths", "harmonic")])
    sheet(fields, fields_labels, args.out / "winding_fields.png")
    sheet(signs, signs_labels, args.out / "sign_differences.png")
    (args.out / "winding_fields.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def deficient_meshes(args, folder):
    """Tabulates each mode's wrong signs against the exact number, and its time, for every deficient mesh."""

    def measure(row, folder):
        file = args.folder / row["file"]
        case = Case(args.raymap, file, 64, folder)
        vertices, triangles = read_mesh(args, file, folder)
        w = {mode: case.run(mode) for mode in MODES}
        index, exact = exact_numbers(vertices, triangles, case)
        wrong = [f"{share_wrong(w[mode][0], index, exact):.3f}" for mode in MODES]
        return [row["file"], len(triangles), *wrong, *(f"{case.milliseconds(mode):.0f}" for mode in MODES)]

    rows = [row for row in mesh_rows(args.folder) if row["kind"] == "defect"]
    titles = ["mesh", "triangles", *MODES, f"ms: {MODES[0]}", *MODES[1:]]
    tabulate(args.out / "deficient_meshes.md", titles, rows, measure, (KeyError,))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--only", default="", help="sections whose name contains this")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for section in (winding_fields, deficient_meshes):
        if args.only in section.__name__:
            with tempfile.TemporaryDirectory() as folder:
                section(args, pathlib.Path(folder))


if __name__ == "__main__":
    main()
