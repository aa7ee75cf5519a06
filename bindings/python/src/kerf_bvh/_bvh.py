"""The hierarchy: rays are traced and questions answered here."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from . import _kerf
from ._arrays import (
    ArrayLike,
    Bool,
    Float32,
    Float64,
    Int64,
    UInt8,
    UInt32,
    array_of,
    faces_of,
    numbers_of,
    rounded,
    rows_of,
    triples_of,
    vertices_of,
)
from ._questions import ALL, Rays, affine_of, boxes_of, check_threads, mask_of, rays_of
from ._results import (
    HIT,
    PRIMITIVE,
    SURFACE_POINT,
    Geometry,
    Hits,
    Lists,
    Measures,
    MeshStatistics,
    Primitives,
    RefitReport,
    Statistics,
    SurfacePoints,
    TouchingPairs,
    hits_of,
    offsets_of,
    primitives_of,
)

Mesh = tuple[ArrayLike, ArrayLike] | ArrayLike
"""Vertices and faces; or the corners of triangles, of shape (t, 3, 3)."""


class BuildOptions(TypedDict, total=False):
    """How to build. The defaults suit most uses."""

    builder: str
    """"sbvh" (the default), "bvh", "esc" or "evh": which hierarchy."""
    quality: str
    """"fast" (the default), "high" or "best": how much time the build spends on a better tree."""
    max_refinement_seconds: float
    """Infinity: "high" and "best" end after this time; the tree then depends on the speed of the machine."""
    alpha: float
    """In [0, 1], 1e-5: spatial splits are tried where children overlap by more than this fraction of the root."""
    max_reference_ratio: float
    """In [1, 16], 1.5: at most so many references per triangle."""
    max_leaf_size: int
    """In [1, 8], 8: at most so many references in a leaf."""
    presplit_references: int
    """For "esc" and "evh": how many references splitting before the build may make; 0 as max_reference_ratio."""
    sample_rays: tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, ArrayLike]
    """Origins and directions of rays such as will be traced, and where they end (t_max) if not at what they hit,
    as `intersect` takes them: the tree is made for these. A few thousand say most."""
    skip_non_finite: bool
    """False: triangles with vertices that are not finite are refused; True: left out and counted."""
    threads: int
    """0, for all: how many threads to use. The hierarchy is the same for any number."""
    progress: Callable[[float], object] | None
    """Called now and then by the calling thread with a fraction in [0, 1]; False cancels the build."""


def _meshes(meshes: Sequence[Mesh], names: Sequence[str]) -> tuple[list[npt.NDArray[Any]], list[npt.NDArray[Any]]]:
    """Vertices and faces of each mesh, in one precision for all."""
    vertices, faces = [], []
    for mesh, name in zip(meshes, names):
        given, numbers = mesh if isinstance(mesh, tuple) else (mesh, None)
        vertices.append(vertices_of(given, f"{name}vertices"))
        is_soup = np.ndim(given) == 3
        faces.append(faces_of(numbers, f"{name}faces", vertices[-1], is_soup))
    if any(array.dtype == np.float64 for array in vertices):
        vertices = [array.astype(np.float64, copy=False) for array in vertices]
    return vertices, faces


def _ray_rows(rays: tuple[ArrayLike, ...]) -> Float32:
    """Origin, direction, t_min and t_max of each ray."""
    if not isinstance(rays, tuple) or len(rays) not in (0, 2, 3):
        raise ValueError("sample_rays: a tuple of origins and directions, and perhaps t_max, is needed")
    if not rays:
        return np.empty((0, 8), np.float32)
    origins, directions = (
        rounded(triples_of(value, f"sample_rays: {name}").reshape(-1, 3))
        for value, name in zip(rays, ("origins", "directions"))
    )
    if len(origins) != len(directions):
        raise ValueError(f"sample_rays: {len(origins)} origins for {len(directions)} directions")
    rows = np.empty((len(origins), 8), np.float32)
    rows[:, 0:3], rows[:, 3:6] = origins, directions
    rows[:, 6], rows[:, 7] = 0.0, np.inf
    if len(rays) == 3:
        t_max = rounded(array_of(rays[2], "sample_rays: t_max").reshape(-1))
        if len(t_max) not in (1, len(rows)):
            raise ValueError(f"sample_rays: {len(t_max)} t_max for {len(rows)} rays")
        rows[:, 7] = t_max
    return rows


def _options(
    *,
    builder: str = "sbvh",
    quality: str = "fast",
    max_refinement_seconds: float = float("inf"),
    alpha: float = 1e-5,
    max_reference_ratio: float = 1.5,
    max_leaf_size: int = 8,
    presplit_references: int = 0,
    sample_rays: tuple[ArrayLike, ...] = (),
    skip_non_finite: bool = False,
    threads: int = 0,
    progress: Callable[[float], object] | None = None,
) -> tuple[str, str, float, float, float, int, int, bool, int, Float32, Callable[[float], object] | None]:
    """The options as the extension takes them."""
    for name_of, value in (("max_leaf_size", max_leaf_size), ("presplit_references", presplit_references)):
        if not 0 <= value < 1 << 31:
            raise ValueError(f"{name_of}: {value} is out of range")
    return (
        builder,
        quality,
        max_refinement_seconds,
        alpha,
        max_reference_ratio,
        max_leaf_size,
        check_threads(threads),
        skip_non_finite,
        presplit_references,
        _ray_rows(sample_rays),
        progress,
    )


def _build(
    meshes: Sequence[Mesh],
    masks: Sequence[int] | None,
    names: Sequence[str],
    **options: Unpack[BuildOptions],
) -> _kerf.Bvh:
    vertices, faces = _meshes(meshes, names)
    if masks is None:
        masks = [ALL] * len(vertices)
    if len(masks) != len(vertices):
        raise ValueError(f"masks: {len(masks)} of them for {len(vertices)} meshes")
    for mask in masks:
        if not 0 <= mask <= ALL:
            raise ValueError(f"masks: {mask}, where a set of 32 bits is needed, from 0 to {ALL}")
    return _kerf.build(vertices, faces, [int(mask) for mask in masks], *_options(**options))


class Bvh:
    """A split bounding volume hierarchy over triangle meshes, ready to trace.

    It never changes but by `refit`: any number of threads may make any call at the same time. Every call releases
    Python's lock and runs on all cores, or on as many threads as `threads=` says; the answers are the same for any
    number.

    All calls take rays, points and boxes in the coordinates of the meshes. Arrays may be of any real type, of any
    strides, read-only, and come from NumPy, from lists, or through DLPack (host memory). float32 is used where it
    lies. float64 is rounded to float32 after the hierarchy's `origin` is subtracted. Questions of shape (..., 3)
    get answers of shape (...).

    Errors: ValueError, TypeError (elements that are not real numbers), MemoryError, OSError, `Cancelled`.
    """

    __slots__ = ("_bvh", "_origin", "_firsts")

    def __init__(
        self,
        vertices: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        **options: Unpack[BuildOptions],
    ) -> None:
        """Builds the hierarchy of one mesh.

        vertices: (n, 3), positions in any unit, each coordinate below 2^126. float32 is taken without a copy
            where the three lie beside each other. float64 is built in a local frame whose place `origin` tells,
            so that surveyed coordinates lose nothing. Or (t, 3, 3), the corners of each triangle, without faces.
            Neither: a hierarchy of nothing, which every ray misses.
        faces: (t, 3), integers below n, counted from 0. 32 bits are taken without a copy.
        options: see `BuildOptions`.

        Degenerate triangles, which have no area, are left out and counted. The arrays may change afterwards.
        Raises ValueError (shapes, ranges, vertices that are not finite), TypeError, MemoryError, Cancelled.
        """
        if vertices is None:
            if faces is not None:
                raise ValueError("faces: given without vertices")
            self._set(_kerf.Bvh())
            return
        mesh: Mesh = vertices if faces is None else (vertices, faces)
        self._set(_build([mesh], None, [""], **options))

    def _set(self, bvh: _kerf.Bvh) -> None:
        self._bvh = bvh
        self._origin: Float64 = np.array(bvh.origin())
        self._firsts: Int64 | None = None

    @classmethod
    def _of(cls, bvh: _kerf.Bvh) -> Bvh:
        new = cls.__new__(cls)
        new._set(bvh)
        return new

    @classmethod
    def from_meshes(
        cls, meshes: Sequence[Mesh], masks: Sequence[int] | None = None, **options: Unpack[BuildOptions]
    ) -> Bvh:
        """Builds one hierarchy over several meshes. Answers name a mesh by its place in `meshes`.

        meshes: tuples of vertices and faces, each as the constructor takes them. If one has float64 vertices, all
            are built in one local frame.
        masks: 32 bits for each mesh: rays that are traced with a `mask` see it if they share a bit.
        """
        if not isinstance(meshes, Sequence):
            raise TypeError("meshes: a list of tuples of vertices and faces is needed")
        names = [f"mesh {i}: " for i in range(len(meshes))]
        return cls._of(_build(meshes, masks, names, **options))

    # Corners that have moved

    def refit(
        self, vertices: ArrayLike, faces: ArrayLike | None = None, **options: Unpack[BuildOptions]
    ) -> RefitReport:
        """Moves the triangles to where they are now, in a fraction of the time of a build.

        vertices, faces: of as many triangles as were built, as the constructor takes them, faces included. The
            frame is the one of the build: what float64 vertices are rounded to are their distances from `origin`.
        options: see `BuildOptions`; used where the hierarchy has to be built anew, because a triangle has an area
            now that the hierarchy does not hold. Else only `threads` and `skip_non_finite` count.

        Every answer is that of a new build; masks stay. What is lost is speed, see `RefitReport.cost_ratio`. Calls
        of other threads answer for all corners as they were before, or for all as they are after. In place unless
        such a call, a scene or a mapped file shares the hierarchy, which is then copied.

        Raises as the constructor does, and ValueError for another number of triangles; the hierarchy is then what
        it was. After a MemoryError in the middle it may be one of nothing.
        """
        return self._refit([vertices if faces is None else (vertices, faces)], [""], options)

    def refit_meshes(self, meshes: Sequence[Mesh], **options: Unpack[BuildOptions]) -> RefitReport:
        """The same for as many meshes as were built, as `from_meshes` takes them."""
        return self._refit(meshes, [f"mesh {i}: " for i in range(len(meshes))], options)

    def _refit(self, meshes: Sequence[Mesh], names: Sequence[str], options: BuildOptions) -> RefitReport:
        vertices, faces = _meshes(meshes, names)
        local = [rows_of(self._local(array)) for array in vertices]
        narrow = [
            numbers if numbers.dtype.itemsize == 4 else faces_of(numbers, f"{name}faces", corners, False)
            for numbers, name, corners in zip(faces, names, local)
        ]
        return RefitReport(*_kerf.refit(self._bvh, local, narrow, *_options(**options)))

    # Rays

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        mask: ArrayLike | None = None,
        accept: ArrayLike | Sequence[ArrayLike] | None = None,
        threads: int = 0,
        out: Hits | None = None,
    ) -> Hits:
        """The closest hit of each ray in [t_min, t_max]. Of several at the same t, the lowest mesh and triangle.

        origins, directions: (..., 3), or (3,) for one that all rays share. Directions have any length but 0; t
            counts in their lengths.
        t_min, t_max: numbers, or (...), which may be negative: a ray may begin behind its origin. One that begins
            on a surface needs a t_min of a little more than 0.
        mask: integers of 32 bits, one or (...): a ray sees the meshes that share a bit with it.
        accept: bool (t,) for one mesh, or a list of these for several: False for triangles that rays pass.
        threads: how many to use, 0 for all.
        out: contiguous arrays to write to, as `Hits.empty(shape)` makes them.

        Returns `Hits` of shape (...): t, u, v float32, primitive, mesh uint32; t is infinite for a miss.
        t is within one unit in the last place of the exact crossing.
        """
        rays, shape = self._rays(origins, directions, t_min, t_max)
        accepted, firsts = self._accepted(accept)
        hits = Hits.empty(shape) if out is None else _checked_hits(out, shape)
        t, u, v, primitive, number = hits._flat()
        _kerf.intersect(
            self._bvh,
            *rays,
            mask_of(mask, shape),
            accepted,
            firsts,
            t,
            u,
            v,
            primitive,
            number,
            check_threads(threads),
        )
        return hits

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        mask: ArrayLike | None = None,
        accept: ArrayLike | Sequence[ArrayLike] | None = None,
        threads: int = 0,
    ) -> Bool:
        """Whether each ray hits anything in [t_min, t_max]: bool (...). Sooner than `intersect`; as that."""
        rays, shape = self._rays(origins, directions, t_min, t_max)
        accepted, firsts = self._accepted(accept)
        answers = np.empty(shape, np.bool_)
        flags = answers.reshape(-1).view(np.uint8)
        _kerf.occluded(self._bvh, *rays, mask_of(mask, shape), accepted, firsts, flags, check_threads(threads))
        return answers

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        threads: int = 0,
    ) -> UInt32:
        """How many triangles each ray crosses in [t_min, t_max]: uint32 (...). As `all_hits`, in half the time."""
        rays, shape = self._rays(origins, directions, t_min, t_max)
        counts = np.empty(shape, np.uint32)
        _kerf.count_hits(self._bvh, *rays, counts.reshape(-1), check_threads(threads))
        return counts

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        threads: int = 0,
    ) -> Lists[Hits]:
        """Every triangle that each ray crosses in [t_min, t_max], once each, in the order of (t, mesh, primitive).

        Both sides count. Crossings are decided in exact arithmetic, without a tolerance. A ray through an edge or
        a vertex counts as moved aside infinitesimally, so that the line of a ray always crosses a closed surface
        an even number of times. Parameters as those of `intersect`.

        Returns `Lists` of `Hits`, one list a ray, in the order of the flattened rays.
        """
        rays, _ = self._rays(origins, directions, t_min, t_max)
        offsets, items = _kerf.all_hits(self._bvh, *rays, check_threads(threads))
        return Lists(offsets_of(offsets), hits_of(items.view(HIT)))

    def geometry(self, origins: ArrayLike, directions: ArrayLike, hits: Hits) -> Geometry:
        """What rays meet at their hits: corners, normals, and whether the front is met, which is exact.

        origins, directions: as they were given to the call that returned `hits`, of the same shape.
        """
        rays, shape = self._rays(origins, directions, 0.0, math.inf)
        if hits.t.shape != shape:
            raise ValueError(f"hits: shape {hits.t.shape}, where that of the rays is needed, {shape}")
        corners = np.full((*shape, 3, 3), np.nan, np.float32)
        normals = np.full((*shape, 3), np.nan, np.float32)
        front = np.zeros(shape, np.bool_)
        flags = front.reshape(-1).view(np.uint8)
        t, u, v, primitive, mesh = hits._flat()
        _kerf.geometry(self._bvh, *rays[:2], t, u, v, primitive, mesh, corners.reshape(-1), normals.reshape(-1), flags)
        return Geometry(self._placed_corners(corners), normals, front)

    # Points

    def contains(self, points: ArrayLike, *, threads: int = 0) -> Bool:
        """Whether points lie inside the closed surface that the triangles make, or on it: bool (...).

        points: (..., 3). Decided exactly, by the parity of the crossings of one ray. For a surface with holes or
        overlaps, the answer is just that parity.
        """
        local, shape = self._points(points, "points")
        inside = np.empty(shape, np.bool_)
        _kerf.contains(self._bvh, local, inside.reshape(-1).view(np.uint8), check_threads(threads))
        return inside

    def side(self, points: ArrayLike, *, threads: int = 0) -> npt.NDArray[np.uint8]:
        """As `contains`, with the surface told from the inside: uint8 (...) of the values of `Side`."""
        local, shape = self._points(points, "points")
        sides = np.empty(shape, np.uint8)
        _kerf.side(self._bvh, local, sides.reshape(-1), check_threads(threads))
        return sides

    def signed_distance(self, points: ArrayLike, *, threads: int = 0) -> Float32:
        """The distance to the closest point of a closed surface, negative inside: float32 (...).

        points: (..., 3). The sign is exact, also where the closest point lies on an edge or a vertex (trimesh
        uses the opposite one). Infinity for an empty hierarchy.
        """
        local, shape = self._points(points, "points")
        distances = np.empty(shape, np.float32)
        _kerf.signed_distance(self._bvh, local, distances.reshape(-1), check_threads(threads))
        return distances

    def closest_point(self, points: ArrayLike, max_distance: float = math.inf, *, threads: int = 0) -> SurfacePoints:
        """The closest point of any triangle within `max_distance` (included), for each point.

        points: (..., 3). max_distance: in the unit of the meshes. Of several at the same distance, the lowest
        mesh and triangle. Where there is none, `found` is False and the distance infinite.

        Returns `SurfacePoints` of shape (...).
        """
        local, shape = self._points(points, "points")
        records = np.empty(shape, SURFACE_POINT)
        data = records.reshape(-1).view(np.uint8)
        _kerf.closest_point(self._bvh, local, data, max_distance, check_threads(threads))
        return self._surface_points(records, points)

    def nearest(
        self, points: ArrayLike, count: int, max_distance: float = math.inf, *, threads: int = 0
    ) -> Lists[SurfacePoints]:
        """The closest points of the `count` triangles that are nearest to each point, nearest first.

        Fewer if not so many lie within `max_distance` (included). Each triangle once; of several at the same
        distance the lowest mesh and triangle first. points: (..., 3). Returns `Lists`, one list a point.
        """
        if count < 0:
            raise ValueError(f"count: {count}, where a number from 0 is needed")
        local, _ = self._points(points, "points")
        offsets, items = _kerf.nearest(self._bvh, local, count, max_distance, check_threads(threads))
        return Lists(offsets_of(offsets), self._surface_points(items.view(SURFACE_POINT), points))

    def within(self, points: ArrayLike, radius: float, *, threads: int = 0) -> Lists[SurfacePoints]:
        """The closest point of every triangle that has a point within `radius` (included), nearest first.

        points: (..., 3). Each triangle once. Returns `Lists`, one list a point.
        """
        local, _ = self._points(points, "points")
        offsets, items = _kerf.within(self._bvh, local, radius, check_threads(threads))
        return Lists(offsets_of(offsets), self._surface_points(items.view(SURFACE_POINT), points))

    # Boxes, other hierarchies, triangles by their numbers

    def triangles_in(self, boxes: ArrayLike, *, threads: int = 0) -> Lists[Primitives]:
        """Every triangle that has a point in a box, once, in the order of (mesh, primitive).

        boxes: (..., 2, 3), the smallest and the largest coordinates. Decided exactly, for the box as it is in
        float32. A triangle that touches the box counts. Returns `Lists`, one list a box.
        """
        corners = np.ascontiguousarray(self._local(boxes_of(boxes)))
        offsets, items = _kerf.triangles_in(self._bvh, corners.reshape(-1), check_threads(threads))
        return Lists(offsets_of(offsets), primitives_of(items.view(PRIMITIVE)))

    def touching_pairs(self, other: Bvh, transform: ArrayLike | None = None) -> TouchingPairs:
        """All pairs of a triangle of this hierarchy and one of `other`, moved, that have a point in common.

        transform: (3, 4) or (4, 4), an affine map of the coordinates of `other`; None leaves it where it is.

        Touching counts. Each pair once. The vertices of `other` are moved in double precision and rounded to
        float32, each once; for the triangles as they are then, the answer is exact.
        """
        pairs = _kerf.touching_pairs(self._bvh, other._bvh, self._transform(other, transform))
        records = pairs.view(np.dtype([("first", PRIMITIVE), ("second", PRIMITIVE)]))
        return TouchingPairs(primitives_of(records["first"]), primitives_of(records["second"]))

    def touches(self, other: Bvh, transform: ArrayLike | None = None) -> bool:
        """Whether there is such a pair. Stops at the first that is found."""
        return _kerf.touches(self._bvh, other._bvh, self._transform(other, transform))

    def triangles(self, primitive: ArrayLike, mesh: ArrayLike = 0) -> npt.NDArray[Any]:
        """The corners of triangles by their numbers: (..., 3, 3), float32, or float64 where `origin` is not 0.

        primitive, mesh: integers (...). NaN for triangles that are in no leaf, because they have no area, or do
        not exist.
        """
        shape = np.broadcast_shapes(np.shape(primitive), np.shape(mesh))
        primitives, meshes = (
            np.ascontiguousarray(np.broadcast_to(array_of(value, name), shape)).reshape(-1)
            for value, name in ((primitive, "primitive"), (mesh, "mesh"))
        )
        numbers = [
            numbers_of(array, name, array.shape, np.uint32)
            for array, name in ((primitives, "primitive"), (meshes, "mesh"))
        ]
        corners = np.full((*shape, 3, 3), np.nan, np.float32)
        _kerf.triangles(self._bvh, numbers[0], numbers[1], corners.reshape(-1))
        return self._placed_corners(corners)

    # Files

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a `.kerf` file. It gets its name when it is complete and on the disk.

        Raises OSError, MemoryError.
        """
        self._bvh.save(Path(path))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Bvh:
        """Reads a file that `save` wrote. Everything in it is checked before it is used.

        Raises ValueError for a damaged or forged file, OSError, MemoryError.
        """
        return cls._of(_kerf.load(readable(path)))

    @classmethod
    def map(cls, path: str | os.PathLike[str]) -> Bvh:
        """As `load`, but maps the file into memory that all processes that do so share.

        Nobody may change or truncate the file meanwhile. Refuses a file of another machine's node width with
        ValueError, which `load` converts.
        """
        return cls._of(_kerf.map(readable(path)))

    def __reduce__(self) -> tuple[Callable[[bytes], Bvh], tuple[bytes]]:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "pickled.kerf")
            self.save(path)
            return _from_bytes, (path.read_bytes(),)

    # What it is

    @property
    def origin(self) -> Float64:
        """float64 (3,): where the local frame lies in which the hierarchy was built: 0 unless float64 needed one."""
        return self._origin.copy()

    @property
    def bounds(self) -> Float64 | None:
        """float64 (2, 3): the smallest and the largest coordinates; None for a hierarchy without triangles."""
        return self._placed_bounds(self._bvh.bounds())

    @property
    def statistics(self) -> Statistics:
        """What the build made, and what it cost."""
        return Statistics(*self._bvh.statistics())

    @property
    def mesh_statistics(self) -> list[MeshStatistics]:
        """What the hierarchy has of each mesh, in the order given to the build."""
        nothing = np.array([[np.inf] * 3, [-np.inf] * 3])
        listed = []
        for triangles, left_out, references, lower, upper in self._bvh.mesh_statistics():
            bounds = self._placed_bounds((lower, upper))
            listed.append(MeshStatistics(triangles, left_out, references, nothing if bounds is None else bounds))
        return listed

    def __repr__(self) -> str:
        statistics = self.statistics
        return f"<kerf_bvh.Bvh of {statistics.triangles} triangles, {statistics.bytes} bytes>"

    # From the caller's arrays to the local frame and back

    def _local(self, array: npt.NDArray[Any]) -> Float32:
        """An array (n, 3) in the local frame."""
        if not self._origin.any():
            return rounded(array)
        local = np.empty(array.shape, np.float32)
        _kerf.to_local(self._bvh, array.astype(np.float64, copy=False), local.reshape(-1))
        return local

    def _points(self, value: ArrayLike, name: str) -> tuple[Float32, tuple[int, ...]]:
        array = triples_of(value, name)
        return rows_of(self._local(array.reshape(-1, 3))), array.shape[:-1]

    def _rays(
        self, origins: ArrayLike, directions: ArrayLike, t_min: ArrayLike, t_max: ArrayLike
    ) -> tuple[Rays, tuple[int, ...]]:
        return rays_of(origins, directions, t_min, t_max, self._local)

    def _accepted(
        self, accept: ArrayLike | Sequence[ArrayLike] | None
    ) -> tuple[UInt8 | None, Int64 | None]:
        return (None, None) if accept is None else self._accepted_triangles(accept)

    def _accepted_triangles(self, accept: ArrayLike | Sequence[ArrayLike]) -> tuple[UInt8, Int64]:
        if self._firsts is None:
            sizes = [0] + [mesh.triangles for mesh in self.mesh_statistics]
            self._firsts = np.cumsum(np.array(sizes, np.int64))
        counts = np.diff(self._firsts)
        flags = list(accept) if isinstance(accept, (list, tuple)) and len(counts) != 1 else [accept]
        if len(flags) == 1 and isinstance(accept, (list, tuple)) and len(accept) == 1 and np.ndim(accept[0]) == 1:
            flags = [accept[0]]
        arrays = [np.asarray(mesh) for mesh in flags]
        for number, array in enumerate(arrays):
            if array.dtype != np.bool_:
                raise TypeError(f"accept: elements of type {array.dtype}, where bool is needed")
            if len(arrays) == len(counts) and array.shape != (counts[number],):
                raise ValueError(f"accept: shape {array.shape} for the {counts[number]} triangles of mesh {number}")
        if len(arrays) != len(counts):
            raise ValueError(f"accept: {len(arrays)} arrays for {len(counts)} meshes")
        return np.concatenate([np.empty(0, np.bool_), *arrays]).view(np.uint8), self._firsts

    def _surface_points(self, records: npt.NDArray[Any], points: ArrayLike) -> SurfacePoints:
        position = records["position"]
        if triples_of(points, "points").dtype == np.float64:
            position = position.astype(np.float64) + self._origin
        elif self._origin.any():
            position = rounded(position.astype(np.float64) + self._origin)
        return SurfacePoints(position, *(records[name] for name in ("distance", "u", "v", "primitive", "mesh")))

    def _placed_corners(self, corners: Float32) -> npt.NDArray[Any]:
        return corners.astype(np.float64) + self._origin if self._origin.any() else corners

    def _placed_bounds(self, bounds: tuple[tuple[float, ...], tuple[float, ...]]) -> Float64 | None:
        array = np.array(bounds)
        return array + self._origin if (array[0] <= array[1]).all() else None

    def _transform(self, other: Bvh, transform: ArrayLike | None) -> list[float]:
        rows = affine_of(np.eye(4) if transform is None else transform, "transform")
        if rows.ndim != 2:
            raise ValueError(f"transform: {len(rows)} maps, where one is needed")
        rows[:, 3] += rows[:, :3] @ other._origin - self._origin
        return [float(number) for number in rows.reshape(-1)]


def _checked_hits(out: Hits, shape: tuple[int, ...]) -> Hits:
    for name, dtype in (("t", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("mesh", "u4")):
        array = getattr(out, name)
        if array.shape != shape or array.dtype != dtype or not array.flags.c_contiguous or not array.flags.writeable:
            raise ValueError(f"out: {name} has to be writeable, contiguous, {np.dtype(dtype)}, and of shape {shape}")
    return out


def readable(path: str | os.PathLike[str]) -> Path:
    """The path, if the file can be opened; else Python's own error for that."""
    with open(path, "rb"):
        return Path(path)


def _from_bytes(data: bytes) -> Bvh:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "pickled.kerf")
        path.write_bytes(data)
        return Bvh.load(path)


def build_memory_bound(triangles: int, *, builder: str = "sbvh", max_reference_ratio: float = 1.5) -> int:
    """An upper bound of the bytes that a build of so many triangles holds at once, whatever the triangles are."""
    if triangles < 0:
        raise ValueError(f"triangles: {triangles}, where a number from 0 is needed")
    return _kerf.build_memory_bound(triangles, builder, max_reference_ratio)


def measure(
    vertices: ArrayLike,
    faces: ArrayLike | None = None,
    *,
    builder: str = "sbvh",
    quality: str = "fast",
    alpha: float = 1e-5,
    max_reference_ratio: float = 1.5,
    max_leaf_size: int = 8,
    threads: int = 0,
) -> Measures:
    """Builds the binary tree of a mesh and measures it. Parameters as those of `Bvh`; float64 is rounded to float32.

    Raises as `Bvh` does.
    """
    corners = vertices_of(vertices, "vertices")
    numbers = faces_of(faces, "faces", corners, np.ndim(vertices) == 3)
    if not 0 <= max_leaf_size < 1 << 31:
        raise ValueError(f"max_leaf_size: {max_leaf_size} is out of range")
    narrow = numbers if numbers.dtype.itemsize == 4 else faces_of(numbers, "faces", rounded(corners), False)
    return Measures(
        *_kerf.measure(
            [rounded(corners)],
            [narrow],
            builder,
            quality,
            alpha,
            max_reference_ratio,
            max_leaf_size,
            check_threads(threads),
        )
    )
