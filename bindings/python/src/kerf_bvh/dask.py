"""Rays and points as Dask arrays, the hierarchy as a `.kerf` file that every machine has in memory once.

    bvh.save("scene.kerf")
    mapped = kerf_bvh.dask.MappedBvh("scene.kerf")    # a path that every worker can read
    distances = mapped.signed_distance(points)        # a Dask array, chunk by chunk

Workers map the file when they first need it, and all workers of a machine share that memory. Only the path and
the chunks travel.
"""

from __future__ import annotations

import functools
import math
import os
from collections.abc import Callable
from typing import Any

import dask.array as da
import numpy as np
import numpy.typing as npt

from ._bvh import Bvh
from ._results import HIT, SURFACE_POINT, Hits, SurfacePoints

__all__ = ["HIT", "SURFACE_POINT", "MappedBvh"]


@functools.lru_cache(maxsize=8)
def _read(path: str, size: int, changed: int) -> Bvh:
    try:
        return Bvh.map(path)
    except ValueError:  # nodes of another width than this machine traces: converted, once for each process
        return Bvh.load(path)


def _bvh(path: str) -> Bvh:
    """The hierarchy of a file, read once in each process."""
    status = os.stat(path)
    return _read(path, status.st_size, status.st_mtime_ns)


def _records(answers: Hits | SurfacePoints, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
    assert dtype.names is not None
    records = np.empty(len(answers), dtype)
    for name in dtype.names:
        records[name] = getattr(answers, name)
    return records


def _intersect(*arrays: npt.NDArray[Any], path: str, limits: Any) -> npt.NDArray[Any]:
    return _records(_bvh(path).intersect(*arrays, *limits), HIT)


def _occluded(*arrays: npt.NDArray[Any], path: str, limits: Any) -> npt.NDArray[Any]:
    return _bvh(path).occluded(*arrays, *limits)


def _count_hits(*arrays: npt.NDArray[Any], path: str, limits: Any) -> npt.NDArray[Any]:
    return _bvh(path).count_hits(*arrays, *limits)


def _contains(points: npt.NDArray[Any], path: str) -> npt.NDArray[Any]:
    return _bvh(path).contains(points)


def _signed_distance(points: npt.NDArray[Any], path: str) -> npt.NDArray[Any]:
    return _bvh(path).signed_distance(points)


def _closest_point(points: npt.NDArray[Any], path: str, max_distance: float) -> npt.NDArray[Any]:
    found = _bvh(path).closest_point(points, max_distance)
    position = found.position.astype(points.dtype, copy=False)
    return _records(SurfacePoints(position, *list(vars(found).values())[1:]), _surface_point(points.dtype))


def _surface_point(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """The record of a closest point, its position of the type of the points."""
    precision = np.float32 if dtype.kind == "f" and dtype.itemsize <= 4 else np.float64
    fields: list[Any] = [("position", precision, (3,))]
    assert SURFACE_POINT.names is not None
    return np.dtype(fields + [(name, SURFACE_POINT[name]) for name in SURFACE_POINT.names[1:]])


def _of_triples(array: Any, name: str) -> da.Array:
    """A Dask array (n, 3), chunked along n only."""
    array = da.asarray(array)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: shape {array.shape}, where (n, 3) is needed")
    return array.rechunk({1: 3})


class MappedBvh:
    """The hierarchy of a `.kerf` file, asked by Dask. Each call returns a Dask array, one chunk for each of the
    chunks of its first argument; see `Bvh` for what the calls answer. Tasks use all cores, or those that the
    worker is bound to."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """path: of a file that `Bvh.save` wrote and every worker can read, and that nobody changes meanwhile."""
        self._path = os.path.abspath(path)
        _bvh(self._path)  # a file that is not right is refused here, not in the workers

    @property
    def bvh(self) -> Bvh:
        """The hierarchy in this process."""
        return _bvh(self._path)

    def intersect(self, origins: Any, directions: Any, t_min: float = 0.0, t_max: float = math.inf) -> da.Array:
        """The closest hits of rays, origins and directions (n, 3): records (n,) with the fields of `Hits`."""
        return self._of_rays(_intersect, HIT, origins, directions, t_min, t_max)

    def occluded(self, origins: Any, directions: Any, t_min: float = 0.0, t_max: float = math.inf) -> da.Array:
        """Whether rays hit anything: bool (n,)."""
        return self._of_rays(_occluded, np.dtype(np.bool_), origins, directions, t_min, t_max)

    def count_hits(self, origins: Any, directions: Any, t_min: float = 0.0, t_max: float = math.inf) -> da.Array:
        """How many triangles rays cross: uint32 (n,)."""
        return self._of_rays(_count_hits, np.dtype(np.uint32), origins, directions, t_min, t_max)

    def contains(self, points: Any) -> da.Array:
        """Whether points (n, 3) lie inside a closed surface, or on it: bool (n,)."""
        return self._of_points(_contains, np.dtype(np.bool_), points)

    def signed_distance(self, points: Any) -> da.Array:
        """The distances of points (n, 3), negative inside: float32 (n,)."""
        return self._of_points(_signed_distance, np.dtype(np.float32), points)

    def closest_point(self, points: Any, max_distance: float = math.inf) -> da.Array:
        """The closest points of points (n, 3): records (n,) with the fields of `SurfacePoints`."""
        array = _of_triples(points, "points")
        return self._of_points(_closest_point, _surface_point(array.dtype), array, max_distance=max_distance)

    def _of_points(self, call: Callable[..., Any], dtype: np.dtype[Any], points: Any, **kwargs: Any) -> da.Array:
        array = _of_triples(points, "points")
        return array.map_blocks(
            call, path=self._path, drop_axis=1, dtype=dtype, meta=np.empty(0, dtype), **kwargs
        )

    def _of_rays(
        self, call: Callable[..., Any], dtype: np.dtype[Any], origins: Any, directions: Any, t_min: float, t_max: float
    ) -> da.Array:
        from_, along = _of_triples(origins, "origins"), _of_triples(directions, "directions")
        if from_.shape != along.shape:
            raise ValueError(f"origins and directions: shapes {from_.shape} and {along.shape} differ")
        along = along.rechunk(from_.chunks)
        return da.map_blocks(
            call,
            from_,
            along,
            path=self._path,
            limits=(t_min, t_max),
            drop_axis=1,
            dtype=dtype,
            meta=np.empty(0, dtype),
        )
