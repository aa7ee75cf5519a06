"""Open3D's `RaycastingScene` over NumPy, answered by kerf. Open3D itself is not needed.

    scene = kerf_bvh.open3d.RaycastingScene()
    scene.add_triangles(vertices, triangles)
    print(scene.cast_rays(rays)["t_hit"])

Tensors are taken through DLPack; answers are NumPy arrays of the shapes and types of Open3D's tensors. What
differs: hits of all rays are exact, so that counts through closed surfaces are always even; inside and outside
are decided exactly, whatever `nsamples` says; vertices may be float64, in a local frame.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from ._arrays import ArrayLike, Bool, Float32, array_of
from ._bvh import Bvh
from ._results import INVALID, Hits, SurfacePoints

__all__ = ["RaycastingScene"]

Int32 = npt.NDArray[np.int32]


class RaycastingScene:
    """Takes the place of `open3d.t.geometry.RaycastingScene`. The hierarchy is built by the first question."""

    INVALID_ID: ClassVar[int] = INVALID

    def __init__(self, nthreads: int = 0) -> None:
        """nthreads: how many threads build the hierarchy, 0 for all."""
        self._nthreads = nthreads
        self._meshes: list[tuple[ArrayLike, ArrayLike]] = []
        self._built: Bvh | None = None

    def add_triangles(self, vertex_positions: Any, triangle_indices: ArrayLike | None = None) -> int:
        """Adds a mesh: vertices (n, 3) and triangles (m, 3), or one object that has both. Returns its number.

        An object is a TriangleMesh of Open3D, of either kind. Arrays are copied.
        """
        if triangle_indices is None:
            mesh = vertex_positions
            if hasattr(mesh, "vertex"):
                vertex_positions, triangle_indices = mesh.vertex["positions"], mesh.triangle["indices"]
            elif hasattr(mesh, "triangles"):
                vertex_positions, triangle_indices = mesh.vertices, mesh.triangles
            else:
                raise TypeError(f"add_triangles: {type(mesh).__name__} is no mesh, and no triangles are given")
        vertices, triangles = array_of(vertex_positions, "vertices"), array_of(triangle_indices, "triangles")
        self._meshes.append((vertices.copy(), triangles.copy()))
        self._built = None
        return len(self._meshes) - 1

    @property
    def bvh(self) -> Bvh:
        """The hierarchy of all meshes, with every call that kerf has."""
        if self._built is None:
            self._built = Bvh.from_meshes(self._meshes, threads=self._nthreads) if self._meshes else Bvh()
        return self._built

    def cast_rays(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, npt.NDArray[Any]]:
        """The first hit of each ray (..., 6), origin and direction.

        Returns t_hit (...) float32, infinite for a miss; geometry_ids, primitive_ids (...) uint32; primitive_uvs
        (..., 2) and primitive_normals (..., 3) float32, of unit length.
        """
        origins, directions = _rays(rays)
        hits = self.bvh.intersect(origins, directions, threads=nthreads)
        return {"t_hit": hits.t, **self._of(hits), "primitive_normals": self._normals(hits)}

    def test_occlusions(
        self, rays: ArrayLike, tnear: float = 0.0, tfar: float = float("inf"), nthreads: int = 0
    ) -> Bool:
        """Whether each ray (..., 6) hits anything from tnear to tfar: bool (...)."""
        return self.bvh.occluded(*_rays(rays), tnear, tfar, threads=nthreads)

    def count_intersections(self, rays: ArrayLike, nthreads: int = 0) -> Int32:
        """How many triangles each ray (..., 6) crosses: int32 (...)."""
        return self.bvh.count_hits(*_rays(rays), threads=nthreads).view(np.int32)

    def list_intersections(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, npt.NDArray[Any]]:
        """All hits of each ray (..., 6), nearest first.

        Returns ray_splits (rays + 1) int64: where the hits of each ray begin in the others; ray_ids, geometry_ids,
        primitive_ids (hits) uint32; t_hit (hits), primitive_uvs (hits, 2) float32.
        """
        lists = self.bvh.all_hits(*_rays(rays), threads=nthreads)
        ids = lists.question.astype(np.uint32)
        return {"ray_splits": lists.offsets, "ray_ids": ids, "t_hit": lists.items.t, **self._of(lists.items)}

    def compute_closest_points(self, query_points: ArrayLike, nthreads: int = 0) -> dict[str, npt.NDArray[Any]]:
        """The closest point of the scene for each of the points (..., 3).

        Returns points (..., 3); geometry_ids, primitive_ids (...) uint32; primitive_uvs (..., 2) and
        primitive_normals (..., 3) float32, of unit length.
        """
        found = self.bvh.closest_point(query_points, threads=nthreads)
        return {"points": found.position, **self._of(found), "primitive_normals": self._normals(found)}

    def compute_distance(self, query_points: ArrayLike, nthreads: int = 0) -> Float32:
        """The distance of each of the points (..., 3) to the scene: float32 (...)."""
        return np.array(self.bvh.closest_point(query_points, threads=nthreads).distance)

    def compute_signed_distance(self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1) -> Float32:
        """The same, negative inside of closed surfaces. nsamples: without effect, one ray decides exactly."""
        return self.bvh.signed_distance(query_points, threads=nthreads)

    def compute_occupancy(self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1) -> Float32:
        """1 for points (..., 3) inside of closed surfaces or on them, else 0: float32 (...). nsamples as above."""
        return self.bvh.contains(query_points, threads=nthreads).astype(np.float32)

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Float32:
        """Rays (height, width, 6) through the centres of a camera's pixels, float32.

        create_rays_pinhole(intrinsic_matrix (3, 3), extrinsic_matrix (4, 4), width_px, height_px): the upper
            triangular matrix of the camera, and the map from the world to the camera.
        create_rays_pinhole(fov_deg, center (3,), eye (3,), up (3,), width_px, height_px): the horizontal field
            of view, where the camera looks to, where it stands, and which way is up.
        """
        by_matrix = ("intrinsic_matrix", "extrinsic_matrix", "width_px", "height_px")
        by_place = ("fov_deg", "center", "eye", "up", "width_px", "height_px")
        for names, make in ((by_matrix, _rays_by_matrix), (by_place, _rays_by_place)):
            given = dict(zip(names, args)) | kwargs
            if len(args) + len(kwargs) == len(names) and set(given) == set(names):
                rays: Float32 = make(*(given[name] for name in names))
                return rays
        raise TypeError(f"create_rays_pinhole: takes {', '.join(by_matrix)}; or {', '.join(by_place)}")

    def _of(self, found: Hits | SurfacePoints) -> dict[str, npt.NDArray[Any]]:
        uvs = np.stack([found.u, found.v], axis=-1)
        return {"geometry_ids": found.mesh, "primitive_ids": found.primitive, "primitive_uvs": uvs}

    def _normals(self, found: Hits | SurfacePoints) -> Float32:
        """Unit normals (..., 3) of triangles; 0 where there is none."""
        corners = self.bvh.triangles(found.primitive, found.mesh).astype(np.float64)
        normals = np.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :])
        lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
        unit = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
        return np.asarray(np.nan_to_num(unit), np.float32)


def _rays(rays: ArrayLike) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    array = array_of(rays, "rays")
    if array.ndim == 0 or array.shape[-1] != 6:
        raise ValueError(f"rays: shape {array.shape}, where (..., 6) is needed")
    return array[..., :3], array[..., 3:]


def _rays_by_matrix(intrinsic: ArrayLike, extrinsic: ArrayLike, width: int, height: int) -> Float32:
    camera = array_of(intrinsic, "intrinsic_matrix").astype(np.float64)
    world = array_of(extrinsic, "extrinsic_matrix").astype(np.float64)
    if camera.shape != (3, 3) or world.shape != (4, 4):
        raise ValueError(f"create_rays_pinhole: matrices of shapes {camera.shape} and {world.shape}, not (3, 3), (4, 4)")
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1)
    back = np.linalg.inv(world[:3, :3])
    directions = pixels @ (back @ np.linalg.inv(camera)).T
    origin = -back @ world[:3, 3]
    return np.concatenate([np.broadcast_to(origin, directions.shape), directions], axis=-1).astype(np.float32)


def _rays_by_place(
    fov_deg: float, center: ArrayLike, eye: ArrayLike, up: ArrayLike, width: int, height: int
) -> Float32:
    named = ((center, "center"), (eye, "eye"), (up, "up"))
    to, at, upwards = (array_of(value, name).astype(np.float64) for value, name in named)
    focal = 0.5 * width / np.tan(0.5 * np.radians(fov_deg))
    camera = np.array([[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]])
    forward = (to - at) / np.linalg.norm(to - at)
    across = np.cross(upwards, forward)
    across /= np.linalg.norm(across)
    world = np.eye(4)
    world[:3, :3] = [across, np.cross(forward, across), forward]
    world[:3, 3] = -world[:3, :3] @ at
    return _rays_by_matrix(camera, world, width, height)
