"""Signed distances that PyTorch can differentiate, negative inside.

>>> import raymap, torch  # doctest: +SKIP
>>> surface = raymap.Surface("ball.ply")  # doctest: +SKIP
>>> points = torch.tensor([(0.0, 0.0, 1.5)], requires_grad=True)  # doctest: +SKIP
>>> raymap.torch.signed_distance(surface, points).sum().backward()  # doctest: +SKIP
>>> points.grad  # doctest: +SKIP
tensor([[0., 0., 1.]])
"""

from __future__ import annotations

import importlib
from typing import Any

from ._surface import Surface

try:
    torch: Any = importlib.import_module("torch")  # Any, so that types are the same with PyTorch and without.
except ImportError as error:
    raise ImportError("raymap.torch needs PyTorch; install it with: pip install torch") from error


class _SignedDistance(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(ctx: Any, points: Any, surface: Surface, threads: int | None) -> Any:
        found = surface.query(points, ("distance", "direction"), threads=threads)
        ctx.save_for_backward(torch.where((found.distance < 0)[..., None], found.direction, -found.direction))
        return found.distance.to(points.dtype)

    @staticmethod
    @torch.autograd.function.once_differentiable  # type: ignore[untyped-decorator]
    def backward(ctx: Any, upstream: Any) -> tuple[Any, None, None]:
        (gradient,) = ctx.saved_tensors
        return upstream[..., None] * gradient.to(upstream.dtype), None, None


def signed_distance(surface: Surface, points: Any, *, threads: int | None = None) -> Any:
    """Returns distances at points, (...) for points (..., 3), negative inside, which can be differentiated once.

    The gradient for a point is the unit vector along which its distance grows: away from the closest point of the
    surface outside, towards it inside. It is 0 for a point on the surface, and where several points of the surface are
    equally close, it belongs to one of them. Points that are not finite get NaN.

    Args:
        surface: A surface; without a sign, distances are not negative.
        points: A tensor of positions in the mesh's units, (..., 3), float32 or float64, on any device. The work is done
            on the CPU. The result has its type and is on its device.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape.
        MemoryLimitError: The results do not fit into memory.
        RuntimeError: The gradient is differentiated again.
    """
    if not isinstance(points, torch.Tensor):
        raise TypeError(f"points must be a tensor, not {type(points).__name__}; NumPy: surface.signed_distance(points)")
    return _SignedDistance.apply(points, surface, threads)
