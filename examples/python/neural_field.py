"""One small network that learns the distances of several meshes: python examples/python/neural_field.py [FOLDER] [MESH ...]

Each mesh has grids of features at several resolutions. One network turns the features around a point into a distance. Grids
and network are learnt together (as in NGLOD: Takikawa et al. 2021), from points that `raymap.torch.SurfaceSamples` makes
meanwhile. FOLDER/neural_field.png shows the meshes above the zero sets of the network, which FOLDER/NAME_learnt.ply hold.
Without a MESH, three shapes are made. A CPU core trains them in about two minutes. The example needs PyTorch and matplotlib:
pip install . torch matplotlib
"""

import argparse
import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import raymap
import torch

LEVELS, FEATURES, WIDTH = (6, 12, 24, 48), 4, 64
POINTS, TRUNCATION, REACH = 4096, 0.1, 1.1
BOX = np.array([[-REACH] * 3, [REACH] * 3])


def make_shapes():
    """Returns a twisted ring, a bored block, and a ball of winding sheets: zero sets of functions."""
    steps = np.linspace(-1.1, 1.1, 73)
    x, y, z = np.meshgrid(steps, steps, steps, indexing="ij")
    twist = 0.03 * np.cos(12 * np.arctan2(y, x) + 2 * np.arctan2(z, np.hypot(x, y) - 0.68))
    ring = np.hypot(np.hypot(x, y) - 0.68, z) - 0.27 + twist
    block = np.maximum.reduce([abs(x), abs(y), abs(z)]) - 0.6
    bores = np.minimum.reduce([np.hypot(x, y), np.hypot(y, z), np.hypot(z, x)]) - 0.33
    waves = sum(np.sin(6 * a) * np.cos(6 * b) for a, b in ((x, y), (y, z), (z, x)))
    sheets = np.maximum(abs(waves) / 6 - 0.1, np.sqrt(x**2 + y**2 + z**2) - 1)
    shapes = {"ring": ring, "block": np.maximum(block, -bores), "sheets": sheets}
    fields = {name: raymap.Field(values, [steps[0]] * 3, steps[1] - steps[0]) for name, values in shapes.items()}
    return {name: field.to_mesh() for name, field in fields.items()}


def normalized(mesh):
    """Returns the mesh, scaled into the ball of radius 1 about 0."""
    moved = mesh.vertices - mesh.bounds.mean(axis=0)
    return raymap.Mesh(moved / np.linalg.norm(moved, axis=1).max(), mesh.faces)


class Network(torch.nn.Module):
    """Distances of points (n, 3) to the mesh of a number. It starts as a ball."""

    def __init__(self, meshes):
        super().__init__()
        self.grids = torch.nn.ModuleList(
            torch.nn.ParameterList(0.01 * torch.randn(1, FEATURES, n, n, n) for n in LEVELS) for _ in range(meshes)
        )
        sizes = [3 + FEATURES * len(LEVELS), WIDTH, WIDTH]
        layers = [part for a, b in itertools.pairwise(sizes) for part in (torch.nn.Linear(a, b), torch.nn.ReLU())]
        self.layers = torch.nn.Sequential(*layers, torch.nn.Linear(WIDTH, 1))

    def forward(self, points, mesh):
        places = (points / REACH)[None, None, None]
        features = [torch.nn.functional.grid_sample(grid, places, align_corners=True) for grid in self.grids[mesh]]
        known = torch.cat([points, *(feature[0, :, 0, 0].T for feature in features)], dim=1)
        return points.norm(dim=1) - 0.6 + self.layers(known)[:, 0]


def train(meshes, steps):
    """Returns a network. Each step sees points of every mesh; distances count up to the truncation."""
    samples = raymap.torch.SurfaceSamples(meshes, blocks=steps, block=POINTS, near=0.8, sigma=(0.05, 0.01), threads=None)
    network = Network(len(meshes))
    optimizer = torch.optim.Adam(network.parameters(), lr=0.01)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    rounds = zip(*[iter(torch.utils.data.DataLoader(samples, batch_size=None))] * len(meshes), strict=True)
    for step, blocks in enumerate(rounds):
        optimizer.zero_grad()
        loss = 0
        for block in blocks:
            found, wanted = network(block["points"], int(block["mesh"])), block["distance"]
            difference = found.clamp(-TRUNCATION, TRUNCATION) - wanted.clamp(-TRUNCATION, TRUNCATION)
            loss = loss + difference.abs().mean() / len(meshes)
        loss.backward()
        optimizer.step()
        schedule.step()
        if (step + 1) % max(steps // 10, 1) == 0:
            print(f"step {step + 1}: mean error {loss.item():.4f}", flush=True)
    return network


def zero_set(network, mesh, resolution):
    """Returns the mesh where the network says that the distance is 0."""
    spacing = 2 * REACH / (resolution - 1)
    points = torch.tensor(BOX[0] + spacing * np.moveaxis(np.indices((resolution,) * 3), 0, -1), dtype=torch.float32)
    with torch.no_grad():
        planes = [network(plane.reshape(-1, 3), mesh).reshape(plane.shape[:-1]) for plane in points]
    return raymap.Field(torch.stack(planes).numpy(), BOX[0], spacing).to_mesh()


def show(axes, mesh, title):
    axes.imshow(raymap.generate(mesh, bounds=BOX, resolution=96).render(width=390, height=325))
    axes.set_title(title)
    axes.axis("off")


arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("folder", nargs="?", default="neural_field", type=Path)
arguments.add_argument("meshes", nargs="*", type=Path, metavar="MESH")
arguments.add_argument("--steps", default=600, type=int)
arguments.add_argument("--resolution", default=96, type=int, help="samples along a side of the network's grid")
options = arguments.parse_args()
if len({path.stem for path in options.meshes}) < len(options.meshes):
    arguments.error("two meshes have the same name; rename one")

torch.manual_seed(0)
torch.set_num_threads(1)  # The tensors are small: more threads would wait for each other.
options.folder.mkdir(parents=True, exist_ok=True)
given = {path.stem: raymap.load_mesh(path) for path in options.meshes} or make_shapes()
meshes = {name: normalized(mesh) for name, mesh in given.items()}
network = train(list(meshes.values()), options.steps)
figure, rows = plt.subplots(2, len(meshes), figsize=(4 * len(meshes), 7), squeeze=False, layout="constrained")
for number, (name, mesh) in enumerate(meshes.items()):
    found = zero_set(network, number, options.resolution)
    found.save(options.folder / f"{name}_learnt.ply")
    error = abs(raymap.Surface(mesh).signed_distance(raymap.sample_faces(found, step=0.05).position)).mean()
    text = f"{name}: mean error {error:.4f}"
    print(text)
    show(rows[0, number], mesh, name)
    show(rows[1, number], found, text)
figure.savefig(options.folder / "neural_field.png", dpi=100)
