"""Closed meshes, and the ways in which scripts/wild.py breaks them. All of it depends on seeds alone."""

import contextlib
import dataclasses
import pathlib

import numpy as np
from broken import torus
from harness import exact_distance, uniform_points


def knot(rings=160, sides=12):
    """Returns a tube about a trefoil."""
    t = np.linspace(0, 2 * np.pi, rings, endpoint=False)
    line = lambda t: np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=-1)  # noqa: E731
    ahead, bend = line(t + 1e-3) - line(t - 1e-3), line(t + 1e-3) + line(t - 1e-3) - 2 * line(t)
    across = np.cross(ahead, bend)
    normal, across = ((w / np.linalg.norm(w, axis=1)[:, None])[:, None] for w in (np.cross(across, ahead), across))
    angle = (2 * np.pi * np.arange(sides) / sides)[:, None]
    return (line(t)[:, None] + 0.4 * (np.cos(angle) * normal + np.sin(angle) * across)).reshape(-1, 3), torus(rings, sides)[1][:, ::-1]


def comb(count=6):
    """Returns the boundary of a base with fins whose thickness is a fortieth of the length: two triangles for each side of a
    cell of a grid that faces an empty one."""
    is_filled, quads = np.zeros((2 * count + 3, 8, 10), bool), []
    is_filled[1:-1, 1:-1, 1] = is_filled[1:-1:2, 1:-1, 1:-1] = True
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
        for way in (0, 1):
            a = np.argwhere(is_filled & ~np.roll(is_filled, 1 - 2 * way, axis)) + way * np.eye(3, dtype=int)[axis]
            quads.append(np.stack([a, a + u, a + u + v, a + v], axis=1)[:, :: 2 * way - 1])
    vertices, faces = welded(np.concatenate(quads)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3).astype(float))
    gaps = np.where(np.arange(2 * count + 1) % 2, 1.0, 0.3)  # A fin, then the gap to the next.
    vertices[:, 0] = np.concatenate([[0, 0], np.cumsum(gaps)])[vertices[:, 0].astype(int)]
    return vertices, faces


def isosurface(function, samples, half):
    """Returns the surface where the function is 0, in a cube."""
    import raymap

    x = np.linspace(-half, half, samples)
    values = function(*np.meshgrid(x, x, x, indexing="ij")).astype(np.float32)
    made = raymap.Field(values, origin=(-half,) * 3, spacing=x[1] - x[0]).to_mesh()
    return made.vertices, made.faces


def gyroid(x, y, z):
    wave = np.sin(3 * x) * np.cos(3 * y) + np.sin(3 * y) * np.cos(3 * z) + np.sin(3 * z) * np.cos(3 * x)
    return np.maximum((np.abs(wave) - 0.7) / 4, np.sqrt(x**2 + y**2 + z**2) - 1.5)


def drop(x, y, z):
    """Is negative in three balls that run into each other."""
    balls = ((0, 0, 0, 1), (0.8, 0.5, 0.3, 0.6), (-0.6, 0.7, -0.5, 0.7))
    return 1 - sum(np.exp(2 - 2 * ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r**2) for a, b, c, r in balls)


def spikes(ball):
    return ball.vertices * (1 + 0.6 * np.maximum(np.cos(5 * ball.vertices).prod(axis=1), 0) ** 2)[:, None], ball.faces


def joined(*meshes):
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    return np.concatenate([m[0] for m in meshes]), np.concatenate([m[1] + n for m, n in zip(meshes, starts, strict=False)])


def turned(mesh):
    return mesh[0], mesh[1][:, ::-1]


def at(mesh, *place):
    return np.asarray(mesh.vertices) + (place or 0), np.asarray(mesh.faces)


def plate_and_gear(teeth=16):
    """Returns a plate with holes of several widths, and a twisted gear."""
    import manifold3d

    solid, section = manifold3d.Manifold, manifold3d.CrossSection
    plate = solid.cube((3, 2, 0.4)) + solid.cube((0.4, 2, 1.5)) + solid.cylinder(1, 0.6, circular_segments=48).translate((2.1, 1, 0))
    for x, y, radius in ((2.1, 1, 0.35), (0.8, 0.4, 0.15), (0.8, 1.6, 0.15), (2.8, 0.15, 0.08), (2.8, 1.85, 0.08)):
        plate -= solid.cylinder(3, radius, circular_segments=32).translate((x, y, -1))
    angle, radius = 2 * np.pi * np.arange(4 * teeth) / (4 * teeth), np.tile([1, 1, 0.8, 0.8], teeth)
    outline = section([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)])
    gear = solid.extrude(outline - section.circle(0.3, 32), 0.4, 4, 20)
    made = (part.to_mesh64() for part in (plate.refine_to_length(0.25), gear))
    return [(mesh.vert_properties[:, :3], mesh.tri_verts) for mesh in made]


def bunny(samples=30):
    """Returns the surface of a scan that pymeshfix ships, once its holes are closed by a coarse field."""
    import pymeshfix
    import raymap

    scan = pathlib.Path(pymeshfix.__file__).parent / "examples/StanfordBunny.ply"
    made = raymap.generate(str(scan), resolution=samples, close_holes=True).to_mesh()
    return made.vertices, made.faces


def makers():
    from trimesh import creation

    ball = creation.icosphere
    return {
        "ball": lambda: at(ball(3)), "torus": lambda: torus(48, 24), "knot": knot, "comb": comb,
        "ring": lambda: at(creation.annulus(0.6, 1, 0.5, sections=100)),
        "shells": lambda: joined(at(ball(3)), turned(at(ball(3, 0.8))), at(ball(2, 0.5))),
        "parts": lambda: joined(at(creation.box((1, 1, 1)).subdivide().subdivide(), 1, 2, 0), at(creation.capsule(1, 0.4, (16, 16))),
                                at(creation.cone(0.6, 1.4, 40), 2, 0, 0), at(ball(2, 0.5), -1, 1.5, 0.5)),
        "gyroid": lambda: isosurface(gyroid, 23, 1.7), "drop": lambda: isosurface(drop, 22, 2.2), "spikes": lambda: spikes(ball(4)),
        "gear": lambda: plate_and_gear()[1], "drilled plate": lambda: plate_and_gear()[0], "bunny": bunny}  # fmt: skip


def rounded(vertices):
    """Returns positions that single precision holds, as many formats and peers have no more."""
    return np.asarray(vertices).astype(np.float32).astype(float)


def closed_meshes(only=None):
    """Returns the meshes by name, or only some. Leaves out those whose package is missing."""
    found = {}
    for name, make in makers().items():
        with contextlib.suppress(ImportError):
            if not only or name in only:
                vertices, faces = make()
                found[name] = rounded(vertices), np.asarray(faces, np.int64)
    return found


def with_cavity(mesh):
    """Returns a mesh with a ball cut out where it is thickest, and which faces are those of the ball."""
    import igl
    from trimesh.creation import icosphere

    points = uniform_points(mesh[0], 3000, np.random.default_rng(0))
    depth = np.where(igl.fast_winding_number(*mesh, points) > 0.5, exact_distance(mesh, points), 0)
    hollow = turned(at(icosphere(2, 0.6 * depth.max()), *points[depth.argmax()]))
    vertices, faces = joined(mesh, hollow)
    return (rounded(vertices), faces), np.arange(len(faces)) >= len(mesh[1])


@dataclasses.dataclass
class Broken:
    """Triangles that come from the faces of a closed mesh."""

    random: np.random.Generator
    triangles: np.ndarray  # (n, 3, 3)
    face: np.ndarray  # Their faces in the closed mesh, or -1.
    sound: np.ndarray  # Which faces of the closed mesh were not changed.
    diagonal: float
    strength: float = 1.0  # Scales the shares.
    moved: float = 0.0  # Largest distance by which a corner moved.
    is_soup: bool = False

    def share(self, low, high):
        return self.strength * self.random.uniform(low, high)

    def some(self, low, high):
        return self.random.random(len(self.triangles)) < self.share(low, high)

    def patch(self, low, high):
        """Returns which triangles are nearest to a random one: a share of all."""
        middles = self.triangles.mean(axis=1)
        away = np.linalg.norm(middles - middles[self.random.integers(len(middles))], axis=1)
        return away <= np.quantile(away, self.share(low, high))

    def spoil(self, chosen):
        self.sound[self.face[chosen & (self.face >= 0)]] = False

    def add(self, triangles, face=-1):
        self.triangles = np.concatenate([self.triangles, triangles])
        self.face = np.concatenate([self.face, np.broadcast_to(face, len(triangles))])

    def remove(self, chosen):
        self.spoil(chosen)
        self.triangles, self.face = self.triangles[~chosen], self.face[~chosen]

    def turn(self, chosen):
        self.spoil(chosen)
        self.triangles[chosen] = self.triangles[chosen][:, ::-1]


def doubled(b):
    chosen = b.some(0.1, 0.6)
    b.add(b.triangles[chosen][:, ::-1], b.face[chosen])


def repeated(b):
    for _ in range(b.random.integers(1, 3)):
        chosen = b.some(0.1, 0.4)
        b.add(b.triangles[chosen], b.face[chosen])


def holes(b):
    for _ in range(b.random.integers(1, 7)):
        b.remove(b.patch(0.002, 0.02))


def cracks(b):
    for _ in range(b.random.integers(2, 7)):
        chosen, move = b.patch(0.02, 0.15), b.random.normal(size=3)
        move *= b.diagonal * b.random.uniform(1e-4, 1e-3) / np.linalg.norm(move)
        b.spoil(chosen)
        b.triangles[chosen] += move
        b.moved += np.linalg.norm(move)


def noise(b):
    vertices, faces = welded(b.triangles)
    move, size = b.random.uniform(-1, 1, vertices.shape), b.diagonal * b.random.uniform(1e-4, 5e-4)
    b.triangles = (vertices + size * move)[faces]
    b.moved += size * np.linalg.norm(move, axis=1).max()
    b.sound[:] = False


def soup(b):
    b.is_soup = True
    count = int(np.ceil(b.share(0.005, 0.03) * len(b.triangles)))
    corners = b.triangles[b.random.integers(len(b.triangles), size=count), 0]
    b.add(corners[:, None] + 0.03 * b.diagonal * b.random.normal(size=(count, 3, 3)))


def sheets(b):
    for _ in range(b.random.integers(1, 4)):
        u, v = 0.2 * b.diagonal * np.linalg.qr(b.random.normal(size=(3, 2)))[0].T * b.random.uniform(0.3, 1, (2, 1))
        a = b.triangles.reshape(-1, 3)[b.random.integers(3 * len(b.triangles))] + 0.1 * b.diagonal * b.random.normal(size=3)
        b.add(np.array([[a, a + u, a + u + v], [a, a + u + v, a + v]]))


def everything(b):
    b.strength = 0.3
    for way in b.random.permutation([WAYS[name] for name in ("turned", "doubled", "repeated", "holes", "cracks", "noise", "soup", "sheets")]):
        way(b)


# "nested" turns the faces of the cavity that broken() cuts out before.
WAYS = {"turned": lambda b: b.turn(b.some(0.05, 0.3) | b.patch(0, 0.3)), "doubled": doubled, "repeated": repeated, "holes": holes,
        "cracks": cracks, "noise": noise, "soup": soup, "nested": lambda b: None, "sheets": sheets,
        "missing": lambda b: b.remove(b.patch(0.08, 0.25)), "all at once": everything}  # fmt: skip


def welded(triangles):
    vertices, index = np.unique(triangles.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    return vertices, index.reshape(-1, 3)


def broken(mesh, way, seed, hollow=None):
    """Breaks a closed mesh. `hollow` are the faces of its cavity. Returns vertices, faces, the faces that are sound, and `moved`."""
    vertices, faces = mesh
    diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
    b = Broken(np.random.default_rng(seed), vertices[faces], np.arange(len(faces)), np.ones(len(faces), bool), diagonal)
    if way == "nested":
        b.turn(hollow)
    WAYS[way](b)
    b.triangles = rounded(b.triangles[b.random.permutation(len(b.triangles))])
    made = (b.triangles.reshape(-1, 3), np.arange(3 * len(b.triangles)).reshape(-1, 3)) if b.is_soup else welded(b.triangles)
    return *made, b.sound, b.moved
