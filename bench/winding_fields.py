"""Pictures of winding numbers, and of the signs that they give."""

import pathlib

import numpy as np
from evaluation import MODES
from harness import at, exact_winding, field, head, inside, line, load, positions, some_samples, table
from PIL import Image, ImageDraw


def shatter(mesh, reach, where, seed=1):
    """Gives every face corners of its own and moves those of the faces `where` by up to `reach`."""
    random, corners = np.random.default_rng(seed), mesh[0][mesh[1]]
    move = random.normal(size=corners.shape)
    move *= reach * random.random(corners.shape[:2] + (1,)) / np.linalg.norm(move, axis=2, keepdims=True)
    corners[where] += move[where]
    return corners.reshape(-1, 3), np.arange(3 * len(mesh[1])).reshape(-1, 3)


def heat(values):
    """Returns the colours of |w|, from dark at 0 to bright at 1.5, with a white line at 0.5."""
    colours = np.array([[12, 14, 40], [52, 60, 140], [120, 90, 170], [235, 130, 90], [250, 215, 120], [255, 255, 240]])
    v, now = np.clip(np.abs(values), 0, 1.5), inside(values)
    picture = np.stack([np.interp(v, [0, 0.25, 0.5, 0.75, 1, 1.5], colours[:, c]) for c in range(3)], axis=-1).astype(np.uint8)
    edge = np.zeros_like(now)
    edge[1:] |= now[1:] != now[:-1]
    edge[:, 1:] |= now[:, 1:] != now[:, :-1]
    picture[edge] = 255
    return picture


def differences(ours, theirs):
    """Draws Fig. 11: grey where both agree, red where only ours is inside, green where only theirs is."""
    a, b = inside(ours), inside(theirs)
    return np.select([x[..., None] for x in (a & b, a & ~b, ~a & b)], [np.uint8(150), np.uint8([210, 30, 40]), np.uint8([30, 160, 60])],
                     np.uint8(235))  # fmt: skip


def sheet(rows, path, cell=300, text=18):
    """Saves rows of (picture [right, up, 3], label), each row of one size."""
    heights = [int((cell - 6) * row[0][0].shape[1] / row[0][0].shape[0]) for row in rows]
    canvas = Image.new("RGB", (cell * len(rows[0]), sum(heights) + text * len(rows)), "white")
    draw, top = ImageDraw.Draw(canvas), 0
    for row, height in zip(rows, heights):
        for c, (picture, label) in enumerate(row):
            upright = Image.fromarray(np.ascontiguousarray(np.swapaxes(picture, 0, 1)[::-1]))
            canvas.paste(upright.resize((cell - 6, height), Image.NEAREST), (cell * c, top))
            draw.text((cell * c + 4, top + height + 2), label, fill="black")
        top += height + text
    canvas.save(path, optimize=True)


@table
def winding_fields(folder, out="out/evaluation", resolution=100):
    """Wrong signs of five meshes, with Figures 7, 10 and 11 of the paper from our runs: docs/evaluation.md."""
    import igl

    bunny = load(folder / "libigl__bunny.off")
    side, middles = np.ptp(bunny[0], axis=0).max(), bunny[0][bunny[1]].mean(axis=1)
    near = np.linalg.norm(middles - middles[np.argmax(middles[:, 1])], axis=1) < 0.3 * side
    cases = {"bunny": (bunny, 2), "bunny, one region broken": (shatter(bunny, 0.03 * side, near), 2),
             "bunny, shattered": (shatter(bunny, 0.03 * side, slice(None)), 2),
             "bust, scanned, open below": (load(folder / "odedstein__demosthenes-low-res.obj"), 0),
             "body of five parts, open": (load(folder / "geogram__SaraPezzini.obj"), 2)}  # fmt: skip
    head("", *MODES, "harmonic, from libigl's fast one")
    fields, signs_shown = [], []
    for name, (mesh, axis) in cases.items():
        made = {mode: field(mesh, resolution, mode) for mode in MODES}
        grid, w = made["harmonic"], {mode: one.winding for mode, one in made.items()}
        index = some_samples(grid, len(mesh[1]), 32e8)
        exact = exact_winding(mesh, positions(grid, index))
        fast = igl.fast_winding_number(*mesh, positions(grid)).reshape(grid.shape)
        differ = inside(w["harmonic"]) != inside(fast)
        line(name, *(f"{100 * np.mean(inside(at(w[mode], index)) != inside(exact)):.3f} %" for mode in MODES), f"{100 * differ.mean():.3f} %")
        # Fig. 7 shows the middle slice, Fig. 11 the one with most differences, as in the paper.
        middle = grid.shape[axis] // 2
        plane = np.moveaxis(np.indices(grid.shape), 0, -1).take(middle, axis)
        truth = exact_winding(mesh, positions(grid, plane.reshape(-1, 3))).reshape(plane.shape[:2])
        shown = {"exact": truth, **{mode: w[mode].take(middle, axis) for mode in ("rays", "evolution", "harmonic")}}
        fields.append([(heat(values), f"{name}: |w|, {kind}") for kind, values in shown.items()])
        if differ.any():
            most = int(np.argmax(differ.sum(axis=tuple(a for a in range(3) if a != axis))))
            signs_shown.append([(differences(w[mode].take(most, axis), fast.take(most, axis)), f"{name}: {mode}")
                                for mode in ("rays", "paths", "harmonic")])  # fmt: skip
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    sheet(fields, f"{out}/winding_fields.png")
    if signs_shown:
        sheet(signs_shown, f"{out}/sign_differences.png")
