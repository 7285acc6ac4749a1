"""Tables of errors: signs, distances, points, turned and double-sided faces, closed holes, bands and rims."""

import time

import numpy as np
from broken import (broken, overlapping_pair, torus, with_doubled_faces, with_flipped_faces, with_holes,
                    with_missing_faces, with_moved_corners)  # fmt: skip
from harness import (at, exact_distance, exact_winding, field, head, inside, is_wanted, line, load, mesh_rows, near_points,
                     positions, some_samples, table, tabulate, uniform_points)  # fmt: skip

MODES = ("rays", "paths", "evolution", "harmonic")


# Signs.

SIGN_MODES = {"1 ray": ("ray", "spread"), "6 rays": ("rays", "spread"), "paths, 5 passes": ("paths", "spread"),
              "the same, paper's sampling": ("paths", "paper"), "evolution, 5 steps": ("evolution", "spread"),
              "its paper's sampling": ("evolution", "paper"), "harmonic": ("harmonic", "spread")}  # fmt: skip
PUBLISHED = ("common3d__beetle.obj", "common3d__teapot.obj", "trimesh__suzanne.ply", "libigl__truck.obj",
             "meshlab__greek_helmet.obj", "geogram__SaraPezzini.obj", "fast-winding-n__pig-head.ply", "assimp__Wuson.stl",
             "mitsuba-data__bunny_lowres.ply", "meshlab__many_small_holes.ply", "odedstein__demosthenes-low-res.obj",
             "draco__bun_zipper.ply")  # fmt: skip


@table
def signs(folder, resolution=48, only=("",)):
    """Wrong signs, and in brackets the mean error of w, by sign mode: docs/dev/measurements.md."""
    meshes = broken("torus", torus())
    for name in ("common3d__spot.obj", "libigl__bunny.off"):
        meshes |= broken(name, load(folder / name))
    meshes |= {name: load(folder / name) for name in PUBLISHED}
    head("wrong signs (mean error of w)", *SIGN_MODES)
    for name, mesh in meshes.items():
        if not is_wanted(name, only):
            continue
        cells, exact = [], None
        for sign, sampling in SIGN_MODES.values():
            made = field(mesh, resolution, sign, sampling=sampling)
            index = some_samples(made, len(mesh[1]), 4e8)
            exact = exact_winding(mesh, positions(made, index)) if exact is None else exact
            w = at(made.winding, index)
            cells.append(f"{100 * np.mean(inside(w) != inside(exact)):.3f} % ({np.abs(w - exact).mean():.4f})")
        line(name, *cells)


@table
def deficient_meshes(folder, resolution=64, only=("",)):
    """Wrong signs in % and milliseconds of each mode on meshes with defects: docs/dev/mesh_tables.md."""

    def measure(row):
        mesh = load(folder / row["file"])
        wrong, times, exact = [], [], None
        for mode in MODES:
            runs = [field(mesh, resolution, mode) for _ in range(3)]
            index = some_samples(runs[0], len(mesh[1]), 4e8)
            exact = exact_winding(mesh, positions(runs[0], index)) if exact is None else exact
            wrong.append(f"{100 * np.mean(inside(at(runs[0].winding, index)) != inside(exact)):.3f}")
            times.append(f"{min(run.stats['milliseconds'] for run in runs):.0f}")
        return len(mesh[1]), *wrong, *times

    tabulate(mesh_rows(folder, only, "defect"), ("mesh", "triangles", *MODES, f"ms: {MODES[0]}", *MODES[1:]), measure)


@table
def rims(folder, resolutions=(48, 64, 128), only=("",)):
    """Samples of open meshes with another sign than by the sign "exact": docs/dev/decisions/rims.md."""

    def rim_count(vertices, faces):
        """Returns how often the faces pass edges in one direction more than in the other."""
        points = np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1)[faces]
        edges = np.concatenate([points[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
        way = np.where(edges[:, 0] < edges[:, 1], 1, -1)
        unique, index = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        sums = np.bincount(index.reshape(-1), way, len(unique))
        return int(np.abs(sums[unique[:, 0] != unique[:, 1]]).sum())

    def measure(row):
        mesh = load(folder / row["file"])
        counts = []
        for turns, n in ((turns, n) for turns in ("keep", "auto") for n in resolutions):
            is_in = [field(mesh, n, sign, orientation=turns).distance < 0 for sign in ("harmonic", "exact")]
            counts.append(np.sum(is_in[0] != is_in[1]))
        return row["triangles"], rim_count(*mesh), *counts

    rows = [row for row in mesh_rows(folder, only) if row["balanced"] == "no"]
    tabulate(rows, ("mesh", "triangles", "rims", *(f"wrong at {n}, {o}" for o in ("keep", "auto") for n in resolutions)), measure)


# Distances, points and bands.


@table
def distances(folder, resolution=64):
    """Errors in samples of the paper's unsigned distances: docs/dev/measurements.md."""
    head("mesh", "method", "max", "mean", "wrong", "max near", "mean near", "wrong near")
    for name in ("draco__bun_zipper.ply", "fcpw__armadillo.obj", "common3d__igea.ply", "common3d__spot.obj",
                 "common3d__fandisk.obj", "libigl__truck.obj"):  # fmt: skip
        mesh = load(folder / name)
        exact = field(mesh, resolution, "none", arrays=("distance",))
        for mode in ("neighbours", "cell", "raster"):
            made = field(mesh, resolution, "none", arrays=("distance",), distance=mode)
            errors = np.abs(made.distance.astype(float) - exact.distance) / exact.spacing
            groups = errors.ravel(), errors[exact.distance <= 1.5 * exact.spacing]
            cells = [(f"{e.max():.3f}", f"{e.mean():.5f}", f"{100 * np.mean(e > 1e-4):.2f} %") for e in groups]
            line(name, f"`{mode}`", *cells[0], *cells[1])


@table
def points(folder, count=100_000, only=("",)):
    """Errors of `Surface` at points: docs/points.md. To be expected: closer to the surface than 5e-8 diagonals."""
    import raymap

    def compare(mesh, asked):
        vertices, faces = mesh
        answers = raymap.Surface(*mesh, orientation="keep").query(asked, ("distance", "closest", "triangle", "barycentric"))
        diagonal, distance = np.linalg.norm(np.ptp(vertices, axis=0)), exact_distance(mesh, asked)
        closest = np.einsum("pc,pcx->px", answers.barycentric, vertices[faces[answers.triangle]])
        errors = (np.abs(np.abs(answers.distance) - distance), np.linalg.norm(closest - answers.closest, axis=1),
                  np.abs(np.linalg.norm(answers.closest - asked, axis=1) - distance))  # fmt: skip
        wrong = inside(exact_winding(mesh, asked)) != (answers.distance < 0)
        return wrong.sum(), (wrong & (distance <= 5e-8 * diagonal)).sum(), np.max(errors) / diagonal

    def measure(row):
        random, mesh = np.random.default_rng(1), load(folder / row["file"])
        uniform = compare(mesh, uniform_points(mesh[0], count, random))
        near = compare(mesh, near_points(mesh, count, random))
        return len(mesh[1]), row["balanced"], uniform[0], near[0], uniform[1] + near[1], f"{max(uniform[2], near[2]):.1e}"

    titles = ("mesh", "triangles", "balanced", "wrong, uniform", "wrong, near", "to be expected", "largest error / diagonal")
    tabulate(mesh_rows(folder, only), titles, measure)


def active_samples(band, leaves):
    """Returns the numbers of the active samples of some leaves, (n, 3), and their distances."""
    values = band.distance[leaves]
    leaf, *place = np.nonzero((values < np.float32(band.outside)) & (values > np.float32(-band.inside)))
    return band.origins[leaves[leaf]] + np.stack(place, axis=1), values[(leaf, *place)]


def samples_beyond(band, count, random):
    """Returns samples beyond the band: half of them from tiles, which lie inside, if there are any."""
    shape = np.array(band.shape)
    anywhere = random.integers(0, shape, (4 * count, 3))
    if len(band.tile_origins):
        sides = band.tile_sides.astype(float)
        tiles = random.choice(len(sides), 2 * count, p=sides**3 / (sides**3).sum())
        chosen = band.tile_origins[tiles] + random.integers(0, band.tile_sides[tiles, None], (2 * count, 3))
        anywhere[: 2 * count] = np.minimum(chosen, shape - 1)
    beyond = np.abs(band.sample(positions(band, anywhere), outside="bound")) >= np.float32(band.outside)
    return random.permutation(anywhere[beyond])[:count]


@table
def bands(folder, resolution=512, openvdb_resolution=256, count=2000, everything=False, only=("",)):
    """Errors of bands of 3 samples, beside OpenVDB's: docs/dev/decisions/narrow_bands.md.

    Compares `count` active samples of each band, or all with --everything, and as many beyond it, which must be farther away."""
    import raymap
    from speed import openvdb_field

    def wrong_signs(mesh, band, samples, values):
        w = np.abs(exact_winding(mesh, positions(band, samples)))
        clear = (np.abs(w - 0.5) > 1e-5) & (np.abs(values) > 1e-5 * band.spacing)
        return int((clear & ((w > 0.5) != (values < 0))).sum())

    def measure(row):
        random, mesh = np.random.default_rng(1), load(folder / row["file"])
        make = lambda n: raymap.generate(*mesh, resolution=n, band=3, sparse=True, orientation="keep")  # noqa: E731
        some = lambda band: active_samples(band, random.permutation(len(band.origins))[:count])  # noqa: E731
        band = make(resolution)
        active, values = active_samples(band, np.arange(len(band.origins))) if everything else some(band)
        few, beyond = random.permutation(len(active))[:count], samples_beyond(band, count, random)
        compared = slice(None) if everything else few
        error = np.abs(np.abs(values[compared]) - exact_distance(mesh, positions(band, active[compared]))).max(initial=0)
        error = max(error / band.spacing, 3 - exact_distance(mesh, positions(band, beyond)).min(initial=np.inf) / band.spacing)
        wrong = wrong_signs(mesh, band, active[few], values[few])
        wrong_beyond = wrong_signs(mesh, band, beyond, band.sample(positions(band, beyond)))
        cells = [row["triangles"], row["balanced"], len(active), f"{error:.1e}", f"{wrong} of {len(few)}", f"{wrong_beyond} of {len(beyond)}"]
        coarse = make(openvdb_resolution)
        active, beyond = some(coarse)[0], samples_beyond(coarse, count, random)
        peer = openvdb_field(mesh, coarse, 3)
        return *cells, *(wrong_signs(mesh, coarse, s, at(peer, s)) for s in (active, beyond))

    titles = ("mesh", "triangles", "balanced", "active samples", "largest error, samples", "wrong signs, active", "beyond",
              "OpenVDB: active", "beyond")  # fmt: skip
    tabulate(mesh_rows(folder, only), titles, measure)


# Turned and double-sided faces.

CLEAN = ("libigl__bunny.off", "common3d__spot.obj", "common3d__cheburashka.obj", "common3d__homer.obj", "common3d__fandisk.obj",
         "common3d__rocker-arm.obj", "libigl__decimated-max.obj", "sellan__eiffel.obj", "thingi10k__79741.stl",
         "prusaslicer__M3x10_screw.stl")  # fmt: skip
COARSE = ("geogram__joint.off", "trimesh__20mm-xyz-cube.stl", "thingi10k__65004.stl", "trimesh__nested.glb",
          "geomcentral__dodecahedron_poly.obj", "geomcentral__hourglass_ico.obj", "prusaslicer__20mmbox-CR.stl",
          "draco__cube_quads.ply")  # fmt: skip


def flipped_cases(mesh):
    holed = with_holes(mesh, 5, 2)
    for how, right in (("whole", mesh), ("five holes", holed), ("10 % of faces missing", with_missing_faces(mesh, 0.1, 3)),
                       ("five holes and 10 % missing", with_missing_faces(holed, 0.1, 3)),
                       ("two overlapping", overlapping_pair(mesh))):  # fmt: skip
        for share in (0, 0.1, 0.3, 0.5)[: 3 if how == "two overlapping" else 4]:
            yield f"{how}, {100 * share:.0f} % flipped", with_flipped_faces(right, share, 5), right


def doubled_cases(mesh):
    for seed in (11, 12):
        holed = with_holes(mesh, 3, seed)
        yield "every face twice", with_doubled_faces(mesh, 1, seed), mesh
        yield "the same, three holes", with_doubled_faces(holed, 1, seed), holed
        yield "40 % of the faces twice", with_doubled_faces(mesh, 0.4, seed), mesh


def soup_cases(mesh):
    for seed in (11, 12):
        soup = with_moved_corners(mesh, 0.0005, seed)
        yield "coarse soup", soup, mesh
        yield "coarse soup, 40 % flipped", with_flipped_faces(soup, 0.4, seed), mesh


def sides_of(given, right, resolution):
    """Returns the share of wrong signs by method, in %, of the inside that OpenVDB finds, and ours in CPU seconds."""
    import igl
    import open3d
    from speed import openvdb_field

    found = {}
    for orientation in ("keep", "auto", "repair"):
        start = time.process_time()
        made = field(given, resolution, orientation=orientation)
        found[orientation] = made.winding, time.process_time() - start
    index = some_samples(made, len(right[1]), 2e8)
    where = positions(made, index)
    truth = inside(exact_winding(right, where))
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(given[0].astype(np.float32)), open3d.core.Tensor(given[1].astype(np.uint32)))
    answers = {name: inside(at(w, index)) for name, (w, _) in found.items()}
    answers["libigl"] = inside(igl.fast_winding_number(*given, where))
    answers["Open3D"] = scene.compute_occupancy(open3d.core.Tensor(where.astype(np.float32)), nsamples=11).numpy() > 0.5
    answers["OpenVDB"] = at(openvdb_field(given, made), index) < 0
    wrong = {name: 100 * np.mean(answer != truth) for name, answer in answers.items()}
    return wrong, np.mean(answers["OpenVDB"][truth]), found["auto"][1] / found["keep"][1]


def print_sides(folder, cases, resolution, only):
    kinds = {}
    for make, names in cases:
        for name in names:
            for how, given, right in make(load(folder / name)) if is_wanted(name, only) else ():
                kinds.setdefault(how, []).append(sides_of(given, right, resolution))
    methods = list(next(iter(kinds.values()))[0][0])
    head("the mesh", *methods, "OpenVDB finds the inside", "CPU time of auto / keep, at most")
    for how, results in kinds.items():
        wrong = [[result[0][method] for result in results] for method in methods]
        line(how, *(f"{np.mean(shares):.3f}, {max(shares):.3f}" for shares in wrong),
             f"{sum(result[1] > 0.5 for result in results)} of {len(results)}", f"{max(result[2] for result in results):.1f}")  # fmt: skip


@table
def orientation(folder, resolution=64, only=("",)):
    """Wrong signs in %, mean and worst, where faces point the wrong way, beside peers: docs/evaluation.md."""
    print_sides(folder, [(flipped_cases, CLEAN)], resolution, only)


@table
def double_sided(folder, resolution=64, only=("",)):
    """The same where faces stand twice, and of soups: docs/signs.md."""
    print_sides(folder, [(doubled_cases, CLEAN), (soup_cases, COARSE)], resolution, only)


# Closed holes.


def cut(mesh, normal, offset):
    """Returns the part of a mesh below a plane, and the edges of its rim there."""
    vertices, faces = mesh
    height = vertices @ normal - offset
    below = height <= 0
    count = below[faces].sum(axis=1)
    points, kept, rim, middles = list(vertices), [faces[count == 3]], [], {}

    def middle(*edge):
        a, b = sorted(edge)
        if (a, b) not in middles:
            middles[a, b] = len(points)
            points.append(vertices[a] + (vertices[b] - vertices[a]) * height[a] / (height[a] - height[b]))
        return middles[a, b]

    for face in faces[(count == 1) | (count == 2)]:
        polygon, ends = [], {}
        for a, b in zip(face, np.roll(face, -1)):
            polygon += [a] if below[a] else []
            if below[a] != below[b]:
                polygon.append(middle(a, b))
                ends[bool(below[a])] = polygon[-1]
        kept.append([(polygon[0], *pair) for pair in zip(polygon[1:], polygon[2:])])
        rim.append((ends[True], ends[False]))
    return (np.array(points), np.concatenate(kept)), dict(rim)


def area(mesh):
    a, b, c = (mesh[0][mesh[1][:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def cut_off(mesh, normal, degrees):
    """Cuts off the share of the area that a cap of so many degrees has of a sphere's. Returns the rest without and with a
    lid in the plane, and the lid."""
    normal = np.array(normal) / np.linalg.norm(normal)
    least = (1 + np.cos(np.radians(degrees))) / 2 * area(mesh)
    low, high = np.min(mesh[0] @ normal), np.max(mesh[0] @ normal)
    for _ in range(16):
        offset = (low + high) / 2
        low, high = (offset, high) if area(cut(mesh, normal, offset)[0]) < least else (low, offset)
    rest, rim = cut(mesh, normal, low)
    vertices, lid = list(rest[0]), []
    while rim:
        loop = [next(iter(rim))]
        while loop[-1] in rim:
            loop.append(rim.pop(loop[-1]))
        lid += [(b, a, len(vertices)) for a, b in zip(loop, loop[1:])]
        vertices.append(rest[0][loop[1:]].mean(axis=0))
    vertices = np.array(vertices)
    return rest, (vertices, np.concatenate([rest[1], lid])), (vertices, np.array(lid))


def errors_of(made, truth, band=24):
    errors = np.abs(np.subtract(*(np.clip(f.distance.astype(float) / truth.spacing, -band, band) for f in (made, truth))))
    return f"{errors.max():.3f}", f"{errors.mean():.5f}"


def volume(made):
    return np.clip(0.5 - made.distance.astype(float) / made.spacing, 0, 1).sum()


@table
def close_holes(bunny, resolution=96):
    """Errors of closed holes in shapes whose cap is cut off: docs/dev/measurements.md. BUNNY is libigl__bunny.off."""
    import raymap
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=6)
    head("shape, cap", "", "max", "mean", "max to the uncut", "mean to the uncut", "slope", "volume", "volume to the uncut")
    for name, mesh, normal in (("sphere", (ball.vertices, ball.faces), (0.2, 0.3, 0.9)), ("torus", torus(200, 100), (1, 0.1, 0.2)),
                               ("bunny", load(bunny), (1, 0.4, 0))):  # fmt: skip
        whole = field(mesh, resolution)
        grid = dict(shape=whole.shape, origin=whole.origin, voxel_size=whole.spacing, device="cpu")
        for degrees in (5, 15, 30):
            opened, closed, lid = cut_off(mesh, normal, degrees)
            truth = raymap.generate(*closed, **grid)
            near = (raymap.generate(*lid, sign="none", **grid).distance <= 2 * whole.spacing)[1:-1, 1:-1, 1:-1]
            for method in ("`--close-holes`", "plain"):
                made = raymap.generate(*opened, close_holes=method != "plain", **grid)
                slopes = np.linalg.norm(np.gradient(made.distance.astype(float), made.spacing), axis=0)[1:-1, 1:-1, 1:-1]
                share = [f"{100 * (volume(made) / volume(other) - 1):+.4f} %" for other in (truth, whole)]
                line(f"{name}, {degrees}°", method, *errors_of(made, truth), *errors_of(made, whole),
                     f"{np.abs(slopes[near] - 1).mean():.4f}", *share)  # fmt: skip
