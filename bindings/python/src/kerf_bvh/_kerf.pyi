from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt

Float32 = npt.NDArray[np.float32]
UInt32 = npt.NDArray[np.uint32]
UInt8 = npt.NDArray[np.uint8]
Int64 = npt.NDArray[np.int64]
Triple = tuple[float, float, float]

class Cancelled(Exception): ...

class Bvh:
    def __init__(self) -> None: ...
    def origin(self) -> Triple: ...
    def bounds(self) -> tuple[Triple, Triple]: ...
    def statistics(self) -> tuple[int, int, int, int, int, int, int, int, float]: ...
    def mesh_statistics(self) -> list[tuple[int, int, int, Triple, Triple]]: ...
    def save(self, path: str | PathLike[str]) -> None: ...

def load(path: str | PathLike[str]) -> Bvh: ...
def map(path: str | PathLike[str]) -> Bvh: ...
def build(
    vertices: Sequence[npt.NDArray[Any]],
    faces: Sequence[npt.NDArray[Any]],
    masks: Sequence[int],
    builder: str,
    quality: str,
    max_refinement_seconds: float,
    alpha: float,
    max_reference_ratio: float,
    max_leaf_size: int,
    threads: int,
    skip_non_finite: bool,
    presplit_references: int,
    sample_rays: npt.NDArray[np.float32],
    progress: Callable[[float], object] | None,
) -> Bvh: ...
def refit(
    bvh: Bvh,
    vertices: Sequence[npt.NDArray[Any]],
    faces: Sequence[npt.NDArray[Any]],
    builder: str,
    quality: str,
    max_refinement_seconds: float,
    alpha: float,
    max_reference_ratio: float,
    max_leaf_size: int,
    threads: int,
    skip_non_finite: bool,
    presplit_references: int,
    sample_rays: npt.NDArray[np.float32],
    progress: Callable[[float], object] | None,
) -> tuple[float, bool]: ...
def measure(
    vertices: Sequence[npt.NDArray[Any]],
    faces: Sequence[npt.NDArray[Any]],
    builder: str,
    quality: str,
    alpha: float,
    max_reference_ratio: float,
    max_leaf_size: int,
    threads: int,
) -> tuple[float, float, float, int, int, int, int]: ...
def build_memory_bound(triangles: int, builder: str, max_reference_ratio: float) -> int: ...
def intersect(
    bvh: Bvh,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    mask: UInt32 | None,
    accepted: UInt8 | None,
    offsets: Int64 | None,
    t: Float32,
    u: Float32,
    v: Float32,
    primitive: UInt32,
    mesh: UInt32,
    threads: int,
) -> None: ...
def occluded(
    bvh: Bvh,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    mask: UInt32 | None,
    accepted: UInt8 | None,
    offsets: Int64 | None,
    answers: UInt8,
    threads: int,
) -> None: ...
def count_hits(
    bvh: Bvh,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    counts: UInt32,
    threads: int,
) -> None: ...
def all_hits(
    bvh: Bvh, origins: Float32, directions: Float32, t_min: Float32 | None, t_max: Float32 | None, threads: int
) -> tuple[UInt8, UInt8]: ...
def geometry(
    bvh: Bvh,
    origins: Float32,
    directions: Float32,
    t: Float32,
    u: Float32,
    v: Float32,
    primitive: UInt32,
    mesh: UInt32,
    corners: Float32,
    normals: Float32,
    front: UInt8,
) -> None: ...
def contains(bvh: Bvh, points: Float32, inside: UInt8, threads: int) -> None: ...
def side(bvh: Bvh, points: Float32, sides: UInt8, threads: int) -> None: ...
def signed_distance(bvh: Bvh, points: Float32, distances: Float32, threads: int) -> None: ...
def closest_point(bvh: Bvh, points: Float32, closest: UInt8, max_distance: float, threads: int) -> None: ...
def nearest(bvh: Bvh, points: Float32, count: int, max_distance: float, threads: int) -> tuple[UInt8, UInt8]: ...
def within(bvh: Bvh, points: Float32, radius: float, threads: int) -> tuple[UInt8, UInt8]: ...
def to_local(bvh: Bvh, points: npt.NDArray[np.float64], local: Float32) -> None: ...
def closest_on_triangles(
    points: npt.NDArray[np.float64],
    corners: npt.NDArray[np.float64],
    ids: Int64,
    closest: npt.NDArray[np.float64],
    distances: npt.NDArray[np.float64],
) -> None: ...
def triangles_in(bvh: Bvh, boxes: Float32, threads: int) -> tuple[UInt8, UInt8]: ...
def touching_pairs(bvh: Bvh, other: Bvh, transform: Sequence[float]) -> UInt8: ...
def touches(bvh: Bvh, other: Bvh, transform: Sequence[float]) -> bool: ...
def triangles(bvh: Bvh, primitive: UInt32, mesh: UInt32, corners: Float32) -> None: ...

class Scene:
    def instance_count(self) -> int: ...
    def path(self, instance: int) -> tuple[int, ...]: ...
    def bounds(self) -> tuple[Triple, Triple]: ...
    def bytes(self) -> int: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def parts(self) -> tuple[list[Bvh | Scene], list[int], UInt8, UInt8, UInt8, UInt8]: ...

def load_scene(path: str | PathLike[str]) -> Scene: ...
def map_scene(path: str | PathLike[str]) -> Scene: ...
def build_scene(
    objects: Sequence[Bvh | Scene],
    which: UInt32,
    transforms: npt.NDArray[np.float64],
    masks: UInt32,
    numbers: UInt32,
    threads: int,
) -> Scene: ...
def scene_intersect(
    scene: Scene,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    mask: UInt32 | None,
    instances: UInt8 | None,
    starts: Int64 | None,
    firsts: Int64 | None,
    triangles: UInt8 | None,
    hits: UInt8,
    threads: int,
) -> None: ...
def scene_occluded(
    scene: Scene,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    mask: UInt32 | None,
    instances: UInt8 | None,
    starts: Int64 | None,
    firsts: Int64 | None,
    triangles: UInt8 | None,
    answers: UInt8,
    threads: int,
) -> None: ...
def scene_count_hits(
    scene: Scene,
    origins: Float32,
    directions: Float32,
    t_min: Float32 | None,
    t_max: Float32 | None,
    counts: UInt32,
    threads: int,
) -> None: ...
def scene_all_hits(
    scene: Scene, origins: Float32, directions: Float32, t_min: Float32 | None, t_max: Float32 | None, threads: int
) -> tuple[UInt8, UInt8]: ...
def scene_geometry(
    scene: Scene,
    origins: Float32,
    directions: Float32,
    hits: UInt8,
    corners: Float32,
    normals: Float32,
    front: UInt8,
) -> None: ...
def scene_triangles(scene: Scene, ids: UInt8, corners: Float32) -> None: ...
def scene_side(scene: Scene, points: Float32, sides: UInt8, threads: int) -> None: ...
def scene_contains(scene: Scene, points: Float32, inside: UInt8, threads: int) -> None: ...
def scene_signed_distance(scene: Scene, points: Float32, distances: Float32, threads: int) -> None: ...
def scene_closest_point(scene: Scene, points: Float32, closest: UInt8, max_distance: float, threads: int) -> None: ...
def scene_nearest(
    scene: Scene, points: Float32, count: int, max_distance: float, threads: int
) -> tuple[UInt8, UInt8]: ...
def scene_within(scene: Scene, points: Float32, radius: float, threads: int) -> tuple[UInt8, UInt8]: ...
def scene_triangles_in(scene: Scene, boxes: Float32, threads: int) -> tuple[UInt8, UInt8]: ...
def scene_touching_pairs(scene: Scene, other: Scene, transform: Sequence[float], threads: int) -> UInt8: ...
def scene_own_touching_pairs(scene: Scene, threads: int) -> UInt8: ...
def scene_touches(scene: Scene, other: Scene, transform: Sequence[float]) -> bool: ...

# Where kerf is built with CUDA. Arrays and `out` are objects of any library; what is made without `out` is memory and
# the number of its rows.

CudaMade = tuple[CudaMemory, int] | None

class CudaError(RuntimeError): ...

class CudaMemory:
    @property
    def address(self) -> int: ...
    @property
    def device(self) -> int: ...
    def is_written(self) -> bool: ...
    def mark_written(self, stream: int) -> None: ...
    def make_wait(self, stream: int) -> None: ...
    def capsule(
        self, offset: int, shape: list[int], strides: list[int], code: int, bits: int, versioned: bool
    ) -> object: ...
    def fetch(self, offset: int, pitch: int, width: int, to: UInt8) -> None: ...

class CudaBvh:
    def __init__(self) -> None: ...
    @property
    def device(self) -> int: ...
    def bounds(self) -> tuple[Triple, Triple]: ...
    def statistics(self) -> tuple[int, int, int, int, int, int, float]: ...

def cuda_allocate(bytes: int, device: int | None) -> CudaMemory: ...
def cuda_upload(bvh: Bvh, device: int | None) -> CudaBvh: ...
def cuda_build(
    vertices: list[Any],
    faces: list[Any],
    names: list[str],
    max_reference_ratio: float,
    max_leaf_size: int,
    radius: int,
    stream: int,
) -> CudaBvh: ...
def cuda_refit(bvh: CudaBvh, vertices: list[Any], faces: list[Any], names: list[str], stream: int) -> None: ...
def cuda_rays(rays: Any, out: Any, device: int | None, stream: int) -> CudaMade: ...
def cuda_intersect(bvh: CudaBvh, rays: Any, out: Any, stream: int) -> CudaMade: ...
def cuda_occluded(bvh: CudaBvh, rays: Any, out: Any, stream: int) -> CudaMade: ...
def cuda_count_hits(bvh: CudaBvh, rays: Any, out: Any, stream: int) -> CudaMade: ...
def cuda_list_hits(bvh: CudaBvh, rays: Any, offsets: Any, out: Any, stream: int) -> None: ...
def cuda_all_hits(bvh: CudaBvh, rays: Any, stream: int) -> tuple[CudaMemory, CudaMemory, int, int]: ...
def cuda_contains(bvh: CudaBvh, points: Any, out: Any, stream: int) -> CudaMade: ...
def cuda_signed_distance(bvh: CudaBvh, points: Any, out: Any, stream: int) -> CudaMade: ...
def cuda_closest_point(bvh: CudaBvh, points: Any, max_distance: float, out: Any, stream: int) -> CudaMade: ...
def cuda_build_bytes(triangles: int, max_reference_ratio: float, max_leaf_size: int, radius: int) -> int: ...
