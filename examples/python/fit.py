"""A mesh that is fitted to a field by the gradient of its distances: python examples/python/fit.py [FOLDER]

A ball becomes two balls that melt into each other. Each step asks for the distances of random points to the mesh, compares
them with those of the field, and moves the vertices along the gradient that PyTorch finds. Gradients are smoothed over the
mesh (Nicolet et al. 2021, "Large steps in inverse rendering of geometry"). It writes FOLDER/fit.png and the meshes, and needs
PyTorch and matplotlib: pip install . torch matplotlib
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import raymap
import torch

STEPS, POINTS, SMOOTHNESS = 120, 2000, 10
ORIGIN, END = np.array([-1.6, -1.2, -1.2]), np.array([1.6, 1.2, 1.2])


def make_field(distances, spacing):
    """Returns a field of a function of the samples' positions."""
    shape = np.rint((END - ORIGIN) / spacing).astype(int) + 1
    positions = ORIGIN + spacing * np.moveaxis(np.indices(shape), 0, -1)
    return raymap.Field(distances(positions).astype(np.float32), ORIGIN, spacing)


def two_balls(positions, blend=0.2):
    """Returns a function that is 0 on two balls, with a smooth minimum between them."""
    first, second = (np.linalg.norm(positions - (x, 0, 0), axis=-1) - r for x, r in ((-0.65, 0.75), (0.75, 0.5)))
    return -blend * np.logaddexp(-first / blend, -second / blend)


def error_of(mesh):
    """Returns how far the mesh is from the zero set of the target, on average."""
    return float(np.abs(target.sample(raymap.sample_faces(mesh, step=0.05).position)).mean())


target = raymap.generate(make_field(two_balls, 0.05).to_mesh(), bounds=(ORIGIN, END), voxel_size=0.05)
start = make_field(lambda positions: np.linalg.norm(positions, axis=-1) - 0.7, 0.1).to_mesh()
random = np.random.default_rng(0)

# The vertices are those of a matrix times what is optimized: I plus the graph's Laplacian, inverted.
graph = np.zeros((len(start.vertices),) * 2)
for a, b in ((0, 1), (1, 2), (2, 0)):
    graph[start.faces[:, a], start.faces[:, b]] = graph[start.faces[:, b], start.faces[:, a]] = 1
matrix = np.eye(len(graph)) + SMOOTHNESS * (np.diag(graph.sum(axis=1)) - graph)
smooth = torch.from_numpy(np.linalg.inv(matrix))
unknown = torch.tensor(matrix @ start.vertices, requires_grad=True)
optimizer = torch.optim.Adam([unknown], lr=0.03)
for _ in range(STEPS):
    vertices = smooth @ unknown
    surface = raymap.Surface(vertices.detach().numpy(), start.faces, orientation="keep")
    points = random.uniform(ORIGIN, END, (POINTS, 3))
    wanted = torch.from_numpy(target.sample(points).astype(np.float64))
    distance = raymap.torch.signed_distance(surface, torch.from_numpy(points), vertices=vertices)
    optimizer.zero_grad()
    (distance - wanted).square().mean().backward()
    optimizer.step()

fitted = raymap.Mesh((smooth @ unknown).detach().numpy(), start.faces)
folder = Path("fit" if len(sys.argv) < 2 else sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
figure, axes = plt.subplots(1, 3, figsize=(13, 4))
meshes = {"before": start, "after": fitted, "wanted": target.to_mesh()}
for axis, (title, mesh) in zip(axes, meshes.items(), strict=True):
    mesh.save(folder / f"{title}.ply")
    print(f"{title}: mean error {error_of(mesh):.4f}")
    axis.imshow(raymap.generate(mesh, bounds=(ORIGIN, END), resolution=96).render(width=480, height=360))
    axis.set(title=f"{title}: mean error {error_of(mesh):.4f}")
    axis.axis("off")
figure.savefig(folder / "fit.png", dpi=100, bbox_inches="tight")
