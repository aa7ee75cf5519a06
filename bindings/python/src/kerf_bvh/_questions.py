"""What is asked of hierarchies and of scenes alike, as the extension module takes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import ArrayLike, Float32, Float64, UInt32, array_of, numbers_of, rounded, triples_of

ALL = 0xFFFFFFFF
"""The mask of what every ray sees, and of a ray that sees everything but meshes without a bit."""

Rays = tuple[Float32, Float32, Float32 | None, Float32 | None]
"""Origins and directions (n, 3), t_min and t_max (n,)."""


def check_threads(threads: int) -> int:
    if not 0 <= threads < 1 << 31:
        raise ValueError(f"threads: {threads}, where a number from 0 is needed, 0 for all")
    return threads


def rays_of(
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike,
    t_max: ArrayLike,
    to_local: Callable[[npt.NDArray[Any]], Float32],
) -> tuple[Rays, tuple[int, ...]]:
    """Rays whose origins `to_local` rounds, and the shape of the answers."""
    from_, along = triples_of(origins, "origins"), triples_of(directions, "directions")
    try:
        shape = np.broadcast_shapes(from_.shape[:-1], along.shape[:-1])
    except ValueError:
        raise ValueError(
            f"origins and directions: shapes {from_.shape} and {along.shape}, which do not fit each other"
        ) from None
    local = to_local(from_.reshape(-1, 3)).reshape(from_.shape)
    flat = [_flat(array, shape) for array in (local, rounded(along))]
    limits = [
        None if isinstance(value, float) and value == default else numbers_of(value, name, shape, np.float32)
        for value, name, default in ((t_min, "t_min", 0.0), (t_max, "t_max", math.inf))
    ]
    return (flat[0], flat[1], limits[0], limits[1]), shape


def _flat(array: Float32, shape: tuple[int, ...]) -> Float32:
    """An array (..., 3) as (n, 3): without a copy where that can be, a single row with a stride of 0."""
    if array.ndim == 1:
        return np.broadcast_to(array, (math.prod(shape), 3))
    return np.broadcast_to(array, (*shape, 3)).reshape(-1, 3)


def boxes_of(boxes: ArrayLike) -> npt.NDArray[Any]:
    """The corners of boxes (..., 2, 3) as rows (n, 3), two of each."""
    array = triples_of(boxes, "boxes")
    if array.size != 0 and (array.ndim < 2 or array.shape[-2] != 2):
        raise ValueError(f"boxes: shape {array.shape}, where (..., 2, 3) is needed")
    return array.reshape(-1, 3)


def mask_of(mask: ArrayLike | None, shape: tuple[int, ...]) -> UInt32 | None:
    return None if mask is None else numbers_of(mask, "mask", shape, np.uint32)


def affine_of(value: ArrayLike, name: str) -> Float64:
    """Affine maps (3, 4) or (4, 4), or many of them, as a new array (..., 3, 4)."""
    matrices = array_of(value, name).astype(np.float64)
    if matrices.ndim not in (2, 3) or matrices.shape[-2:] not in ((3, 4), (4, 4)):
        raise ValueError(f"{name}: shape {matrices.shape}, where (3, 4) or (4, 4) is needed")
    if matrices.shape[-2] == 4 and (wrong := (matrices[..., 3, :] != [0, 0, 0, 1]).any(axis=-1)).any():
        row = matrices[..., 3, :].reshape(-1, 4)[int(np.argmax(wrong))]
        raise ValueError(f"{name}: its last row is {row.tolist()}, where an affine map has [0, 0, 0, 1]")
    return np.ascontiguousarray(matrices[..., :3, :])
