"""trimesh's queries of rays and of proximity, answered by kerf: exactly, on all cores.

    kerf_bvh.trimesh.use(mesh)    # this mesh
    kerf_bvh.trimesh.use()        # every mesh that is made from now on, and trimesh.proximity

Names, orders of arguments, shapes, types and signs are trimesh's. What differs: multiple hits are found without
moving the origin along, so that none is missed or doubled; a ray that only touches a surface at an edge does not
cross it; coordinates far from the origin answer as those near it.
"""

from __future__ import annotations

import types
from typing import Any

import numpy as np
from trimesh import proximity as _proximity
from trimesh import ray as _ray

from . import _kerf
from ._arrays import ArrayLike, Bool, Float32, Float64, Int64
from ._bvh import Bvh

__all__ = [
    "ProximityQuery",
    "RayMeshIntersector",
    "RayTriangleIntersector",
    "bvh_of",
    "closest_point",
    "contains",
    "restore",
    "signed_distance",
    "use",
]

# Distances that trimesh takes for none (trimesh.constants.tol.merge).
_MERGE = 1e-8

# Hits so near, in parts of the largest coordinate, may be of the surface that a ray begins on: they are looked at
# in double precision, in which a point on a surface lies this near to it.
_NEAR = 2.0**-20
_ON_SURFACE = 2.0**-40


def bvh_of(mesh: Any) -> Bvh:
    """The hierarchy of a mesh. It is kept in the mesh's cache, and built anew after the mesh has changed."""
    cache = mesh._cache
    cache.verify()
    bvh = cache.cache.get("kerf_bvh")
    if bvh is None:
        bvh = Bvh(np.asarray(mesh.vertices), np.asarray(mesh.faces), skip_non_finite=True)
        cache.cache["kerf_bvh"] = bvh
    return bvh  # type: ignore[no-any-return]


def _points(points: ArrayLike) -> Float64:
    array = np.asarray(points, dtype=np.float64)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError("points must be (n,3)!")
    return array


def _size(bvh: Bvh, origins: Float64) -> Float64:
    """The largest coordinate that has to do with each of the rays."""
    bounds = bvh.bounds
    of_mesh = 0.0 if bounds is None else float(np.abs(bounds).max())
    return np.asarray(np.abs(origins).max(axis=1, initial=0.0) + of_mesh)


class RayMeshIntersector:
    """Takes the place of `trimesh.ray.ray_pyembree.RayMeshIntersector`."""

    def __init__(self, geometry: Any, scale_to_box: bool = True) -> None:
        """geometry: the mesh. scale_to_box: without effect, since kerf is exact at every scale."""
        self.mesh = geometry
        self._scale_to_box = scale_to_box

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[Float64, Int64, Int64]:
        """Where rays (n, 3) hit the surface: locations (m, 3), numbers of rays (m,), numbers of faces (m,)."""
        faces, rays, locations = self._hits(ray_origins, ray_directions, multiple_hits)
        return locations, rays, faces

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int = 100,
        return_locations: bool = False,
    ) -> Any:
        """Which faces rays (n, 3) hit: numbers of faces (m,), numbers of rays (m,), and locations (m, 3) if wanted.

        max_hits: at most so many hits of each ray, its nearest.
        """
        faces, rays, locations = self._hits(ray_origins, ray_directions, multiple_hits)
        if multiple_hits and len(rays) != 0:
            first = np.searchsorted(rays, rays)  # rays come in order
            kept = np.arange(len(rays)) - first < max_hits
            faces, rays, locations = faces[kept], rays[kept], locations[kept]
        return (faces, rays, locations) if return_locations else (faces, rays)

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> Int64:
        """The number of the first face that each ray (n, 3) hits, or -1: (n,)."""
        origins, directions = self._rays(ray_origins, ray_directions)
        first = np.full(len(origins), -1, np.int64)
        faces, rays, _ = self._first_hits(origins, directions)
        first[rays] = faces
        return first

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> Bool:
        """Whether each ray (n, 3) hits the surface: (n,)."""
        return np.asarray(self.intersects_first(ray_origins, ray_directions) != -1)

    def contains_points(self, points: ArrayLike) -> Bool:
        """Whether points (n, 3) lie inside the closed surface, or on it: (n,). Decided exactly."""
        return bvh_of(self.mesh).contains(_points(points))

    def _rays(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[Float64, Float64]:
        origins, directions = (np.array(array, np.float64) for array in (ray_origins, ray_directions))
        if origins.shape != directions.shape:
            raise ValueError("Ray origin and direction don't match!")
        if origins.shape == (0,):
            origins, directions = origins.reshape(0, 3), directions.reshape(0, 3)
        if origins.ndim != 2 or origins.shape[1] != 3:
            raise ValueError("rays must be (n,3)!")
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        return origins, np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 0)

    def _hits(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool
    ) -> tuple[Int64, Int64, Float64]:
        origins, directions = self._rays(ray_origins, ray_directions)
        faces, rays, t = (self._all_hits if multiple_hits else self._first_hits)(origins, directions)
        at, along = origins[rays], directions[rays]
        return faces, rays, at + self._distances(at, along, faces, t)[0][:, None] * along

    def _all_hits(self, origins: Float64, directions: Float64) -> tuple[Int64, Int64, Float32]:
        bvh = bvh_of(self.mesh)
        size = _size(bvh, origins)
        lists = bvh.all_hits(origins, directions, -_NEAR * size)
        rays, faces, t = lists.question, lists.items.primitive.astype(np.int64), lists.items.t
        kept = self._count(origins, directions, size, rays, faces, t)
        return faces[kept], rays[kept], t[kept]

    def _first_hits(self, origins: Float64, directions: Float64) -> tuple[Int64, Int64, Float32]:
        bvh = bvh_of(self.mesh)
        size = _size(bvh, origins)
        # A little behind the origin, where rounding to float32 may have left the surface that it lies on.
        hits = bvh.intersect(origins, directions, -_NEAR * size)
        faces, t = hits.primitive.astype(np.int64), hits.t
        asked = np.flatnonzero(hits.hit & (t <= _NEAR * size))
        # Rays that leave the surface that they begin on go on behind it.
        while len(asked := asked[~self._count(origins, directions, size, asked, faces[asked], t[asked])]) != 0:
            more = bvh.intersect(origins[asked], directions[asked], np.nextafter(t[asked], np.float32(np.inf)))
            faces[asked], t[asked] = more.primitive, more.t
            asked = asked[more.hit]
        rays = np.flatnonzero(np.isfinite(t))
        return faces[rays], rays, t[rays]

    def _count(
        self, origins: Float64, directions: Float64, size: Float64, rays: Int64, faces: Int64, t: Float32
    ) -> Bool:
        """Which hits of these rays count: those of a surface that a ray begins on do if the ray goes in, and do not
        if it comes out. Where rays begin is told in double precision."""
        counts = t > _NEAR * size[rays]
        near = np.flatnonzero(~counts)
        if len(near) != 0:
            ray = rays[near]
            exact, is_entered = self._distances(origins[ray], directions[ray], faces[near], t[near])
            on_surface = _ON_SURFACE * size[ray]
            counts[near] = np.where(is_entered, exact >= -on_surface, exact > on_surface)
        return counts

    def _distances(
        self, origins: Float64, directions: Float64, faces: Int64, t: Float32
    ) -> tuple[Float64, Bool]:
        """How far hits are, in double precision, and whether they are of fronts of faces."""
        corners = np.asarray(self.mesh.triangles)[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.einsum("ij,ij->i", normals, directions)
        apart = np.einsum("ij,ij->i", normals, corners[:, 0] - origins)
        is_steep = np.abs(along) > 1e-6 * np.linalg.norm(normals, axis=1)
        return np.divide(apart, along, out=t.astype(np.float64), where=is_steep), along < 0


class RayTriangleIntersector(RayMeshIntersector):
    """Takes the place of `trimesh.ray.ray_triangle.RayMeshIntersector`, whose arguments stand in another order."""

    def __init__(self, mesh: Any) -> None:
        super().__init__(mesh)

    def intersects_location(  # type: ignore[override]
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any
    ) -> tuple[Float64, Int64, Int64]:
        """Where rays (n, 3) hit the surface: locations (m, 3), numbers of rays (m,), numbers of faces (m,)."""
        faces, rays, locations = self._hits(ray_origins, ray_directions, kwargs.get("multiple_hits", True))
        return locations, rays, faces

    def intersects_id(  # type: ignore[override]
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        return_locations: bool = False,
        multiple_hits: bool = True,
        **kwargs: Any,
    ) -> Any:
        """Which faces rays (n, 3) hit: numbers of faces (m,), numbers of rays (m,), and locations (m, 3) if wanted."""
        faces, rays, locations = self._hits(ray_origins, ray_directions, multiple_hits)
        return (faces, rays, locations) if return_locations else (faces, rays)

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any) -> Int64:
        """The number of the first face that each ray (n, 3) hits, or -1: (n,)."""
        return super().intersects_first(ray_origins, ray_directions)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any) -> Bool:
        """Whether each ray (n, 3) hits the surface: (n,)."""
        return super().intersects_any(ray_origins, ray_directions)


def _refined(mesh: Any, points: Float64, faces: Int64) -> tuple[Float64, Float64]:
    """The closest points of these faces, and their distances, in double precision."""
    closest, distances = np.empty_like(points), np.empty(len(points))
    corners = np.ascontiguousarray(mesh.triangles, np.float64)
    _kerf.closest_on_triangles(
        np.ascontiguousarray(points).reshape(-1), corners.reshape(-1), faces, closest.reshape(-1), distances
    )
    return closest, distances


def closest_point(mesh: Any, points: ArrayLike) -> tuple[Float64, Float64, Int64]:
    """The closest point of a mesh for each of the points (m, 3).

    Returns closest points (m, 3), distances (m,), and numbers of faces (m,). Where two faces are equally near,
    which they are along their common edge, it is the one whose normal looks towards the point.
    """
    points = _points(points)
    bvh = bvh_of(mesh)
    found = bvh.closest_point(points)
    if not found.found.all():
        raise ValueError("the mesh has no faces with an area, or a point is not finite")
    faces = found.primitive.astype(np.int64)
    closest, distances = _refined(mesh, points, faces)
    weights = np.minimum(np.minimum(found.u, found.v), 1 - found.u - found.v)
    edge = np.flatnonzero((weights < 1e-6) & (distances > 0))
    pairs = bvh.nearest(points[edge], 2)
    edge, first = edge[pairs.counts == 2], pairs.offsets[:-1][pairs.counts == 2]
    if len(edge) != 0:
        ids = pairs.items.primitive.astype(np.int64)
        both = [(ids[first + i], *_refined(mesh, points[edge], ids[first + i])) for i in range(2)]
        towards = []
        for number, place, distance in both:
            outwards = (points[edge] - place) / distance[:, None]
            towards.append(np.einsum("ij,ij->i", np.asarray(mesh.face_normals)[number], outwards))
        squares = [distance**2 for _, _, distance in both]
        is_tie = np.abs(squares[0] - squares[1]) < 1e-8 * squares[0]
        second = np.where(is_tie, towards[1] > towards[0], squares[1] < squares[0])
        for (number, place, distance), chosen in zip(both, (~second, second)):
            faces[edge[chosen]] = number[chosen]
            closest[edge[chosen]], distances[edge[chosen]] = place[chosen], distance[chosen]
    return closest, distances, faces


def signed_distance(mesh: Any, points: ArrayLike) -> Float64:
    """The distance of points (n, 3) from a closed mesh: (n,), **positive inside**, as in trimesh.

    The sign is exact. Points within 1e-8 of the surface have a positive distance.
    """
    points = _points(points)
    _, distances, _ = closest_point(mesh, points)
    distances[(distances > _MERGE) & ~bvh_of(mesh).contains(points)] *= -1
    return distances


def contains(mesh: Any, points: ArrayLike) -> Bool:
    """Whether points (n, 3) lie inside a closed mesh, or on it: (n,). Decided exactly."""
    return bvh_of(mesh).contains(_points(points))


class ProximityQuery:
    """Takes the place of `trimesh.proximity.ProximityQuery`."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def on_surface(self, points: ArrayLike) -> tuple[Float64, Float64, Int64]:
        """Closest points (m, 3), distances (m,) and numbers of faces (m,), for points (m, 3)."""
        return closest_point(self._mesh, points)

    def vertex(self, points: ArrayLike) -> Any:
        """Distances (n,) to the nearest vertices, and their numbers (n,): by trimesh's own tree (needs SciPy)."""
        return self._mesh.kdtree.query(points)

    def signed_distance(self, points: ArrayLike) -> Float64:
        """As the function of that name: positive inside."""
        return signed_distance(self._mesh, points)


_replaced: list[tuple[Any, str, Any]] = []


def _replace(owner: Any, name: str, value: Any) -> None:
    _replaced.append((owner, name, getattr(owner, name)))
    setattr(owner, name, value)


def use(mesh: Any = None) -> None:
    """Makes a mesh take kerf; or without one, all of trimesh: meshes made from now on, and `trimesh.proximity`."""
    if mesh is not None:
        mesh.ray = RayMeshIntersector(mesh)
        mesh.nearest = ProximityQuery(mesh)
        return
    if _replaced:
        return
    if _ray.has_embree:
        _replace(_ray.ray_pyembree, "RayMeshIntersector", RayMeshIntersector)
    else:
        module = types.ModuleType("trimesh.ray.ray_pyembree", "kerf in the place of embreex.")
        module.RayMeshIntersector = RayMeshIntersector  # type: ignore[attr-defined]
        _replace(_ray, "ray_pyembree", module)
        _replace(_ray, "has_embree", True)
    _replace(_ray.ray_triangle, "RayMeshIntersector", RayTriangleIntersector)
    for name in ("closest_point", "signed_distance", "ProximityQuery"):
        _replace(_proximity, name, globals()[name])


def restore() -> None:
    """Undoes `use()`. Meshes that were made meanwhile keep kerf."""
    while _replaced:
        owner, name, value = _replaced.pop()
        setattr(owner, name, value)
