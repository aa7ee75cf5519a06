"""What queries answer with: columns of NumPy arrays under the names of their fields."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from ._arrays import Bool, Float32, Int64, UInt8, UInt32

INVALID = 0xFFFFFFFF
"""Stands for no triangle, and for no mesh."""

# The records of the library in memory.
HIT = np.dtype([("t", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("mesh", "u4")])
SURFACE_POINT = np.dtype(
    [("position", "f4", (3,)), ("distance", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("mesh", "u4")]
)
SCENE_HIT = np.dtype([*HIT.descr, ("instance", "u4")])
SCENE_POINT = np.dtype(
    [("position", "f4", (3,)), ("distance", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("mesh", "u4"),
     ("instance", "u4")]
)  # fmt: skip
PRIMITIVE = np.dtype([("primitive", "u4"), ("mesh", "u4")])
SCENE_PRIMITIVE = np.dtype([*PRIMITIVE.descr, ("instance", "u4")])


class Side(IntEnum):
    """Where a point lies with regard to a closed surface."""

    OUTSIDE = 0
    ON = 1
    INSIDE = 2


T = TypeVar("T", bound="Columns")


class Columns:
    """Arrays of one length, or of one shape, as fields of a dataclass."""

    def __getitem__(self: T, index: Any) -> T:
        """The same fields of some rows: `index` is whatever NumPy takes for the first axes."""
        return type(self)(*(getattr(self, field.name)[index] for field in fields(self)))  # type: ignore[arg-type]

    def __len__(self) -> int:
        return len(getattr(self, fields(self)[0].name))  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Hits(Columns):
    """Where rays cross triangles with vertices v0, v1, v2: at (1 - u - v) * v0 + u * v1 + v * v2."""

    t: Float32
    """float32: distance in lengths of the direction; infinity for a miss."""
    u: Float32
    """float32: weight of v1; 0 for a miss."""
    v: Float32
    """float32: weight of v2; 0 for a miss."""
    primitive: UInt32
    """uint32: number of the triangle within its mesh; INVALID for a miss."""
    mesh: UInt32
    """uint32: number of the mesh in the order given to the build; INVALID for a miss."""

    @property
    def hit(self) -> Bool:
        """bool: True for a hit, False for a miss."""
        return np.asarray(self.primitive != INVALID)

    @staticmethod
    def empty(shape: int | tuple[int, ...]) -> Hits:
        """Arrays of that shape with nothing in them yet, for `out=`."""
        t, u, v = (np.empty(shape, np.float32) for _ in range(3))
        return Hits(t, u, v, np.empty(shape, np.uint32), np.empty(shape, np.uint32))

    def _flat(self) -> tuple[Float32, Float32, Float32, UInt32, UInt32]:
        t, u, v = (column.reshape(-1) for column in (self.t, self.u, self.v))
        return t, u, v, self.primitive.reshape(-1), self.mesh.reshape(-1)


@dataclass(frozen=True, eq=False)
class SurfacePoints(Columns):
    """The points of triangles that are closest to given points: (1 - u - v) * v0 + u * v1 + v * v2, rounded."""

    position: npt.NDArray[Any]
    """(..., 3), of the type of the points that were given: the point itself."""
    distance: Float32
    """float32: from the given point; infinity where there is none."""
    u: Float32
    """float32: weight of v1."""
    v: Float32
    """float32: weight of v2."""
    primitive: UInt32
    """uint32: number of the triangle within its mesh; INVALID where there is none."""
    mesh: UInt32
    """uint32: number of the mesh in the order given to the build; INVALID where there is none."""

    @property
    def found(self) -> Bool:
        """bool: True for a point, False where there is none."""
        return np.asarray(self.primitive != INVALID)


@dataclass(frozen=True, eq=False)
class SceneHits(Columns):
    """As `Hits`, and the instances that are hit."""

    t: Float32
    """float32: distance in lengths of the direction; infinity for a miss."""
    u: Float32
    """float32: weight of v1; 0 for a miss."""
    v: Float32
    """float32: weight of v2; 0 for a miss."""
    primitive: UInt32
    """uint32: number of the triangle within its mesh; INVALID for a miss."""
    mesh: UInt32
    """uint32: number of the mesh within the object; INVALID for a miss."""
    instance: UInt32
    """uint32: number of the instance, see `Scene.path`; INVALID for a miss."""

    @property
    def hit(self) -> Bool:
        """bool: True for a hit, False for a miss."""
        return np.asarray(self.instance != INVALID)


@dataclass(frozen=True, eq=False)
class ScenePoints(Columns):
    """As `SurfacePoints`, in the coordinates of the scene, and the instances that the triangles are of."""

    position: npt.NDArray[Any]
    """(..., 3), of the type of the points that were given: the point itself."""
    distance: Float32
    """float32: from the given point; infinity where there is none."""
    u: Float32
    """float32: weight of v1."""
    v: Float32
    """float32: weight of v2."""
    primitive: UInt32
    """uint32: number of the triangle within its mesh; INVALID where there is none."""
    mesh: UInt32
    """uint32: number of the mesh within the object; INVALID where there is none."""
    instance: UInt32
    """uint32: number of the instance, see `Scene.path`; INVALID where there is none."""

    @property
    def found(self) -> Bool:
        """bool: True for a point, False where there is none."""
        return np.asarray(self.instance != INVALID)


@dataclass(frozen=True, eq=False)
class Primitives(Columns):
    """Triangles by their place in the meshes."""

    primitive: UInt32
    """uint32: number of the triangle within its mesh."""
    mesh: UInt32
    """uint32: number of the mesh in the order given to the build."""


@dataclass(frozen=True, eq=False)
class ScenePrimitives(Columns):
    """Triangles by their place in the meshes of objects, and the instances that they are of."""

    primitive: UInt32
    """uint32: number of the triangle within its mesh."""
    mesh: UInt32
    """uint32: number of the mesh within the object."""
    instance: UInt32
    """uint32: number of the instance, see `Scene.path`."""


@dataclass(frozen=True, eq=False)
class TouchingPairs(Columns):
    """Pairs of triangles that have a point in common, in the order of `first`, then of `second`."""

    first: Primitives
    """Of the hierarchy that was asked."""
    second: Primitives
    """Of the other."""


@dataclass(frozen=True, eq=False)
class SceneTouchingPairs(Columns):
    """Pairs of triangles of instances that have a point in common, in the order of `first`, then of `second`."""

    first: ScenePrimitives
    """Of the scene that was asked."""
    second: ScenePrimitives
    """Of the other, or of a higher instance of the same."""


class Lists(Generic[T]):
    """A list of answers for each of many questions, one list after the other."""

    def __init__(self, offsets: Int64, items: T) -> None:
        self.offsets = offsets
        """int64 (n + 1): where each list begins in `items`; one more ends the last."""
        self.items = items
        """All answers, in the order of the questions."""

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> T:
        """List `index`."""
        place = range(len(self))[index]
        return self.items[self.offsets[place] : self.offsets[place + 1]]

    @property
    def counts(self) -> Int64:
        """int64 (n): the length of each list."""
        return np.diff(self.offsets)

    @property
    def question(self) -> Int64:
        """int64: for each of `items`, the number of the ray, point or box that it answers."""
        return np.repeat(np.arange(len(self), dtype=np.int64), self.counts)


@dataclass(frozen=True, eq=False)
class Geometry(Columns):
    """What rays meet at hits. A miss has corners and normals of NaN."""

    corners: Float32
    """float32 (..., 3, 3): the corners of the triangle."""
    normal: Float32
    """float32 (..., 3): of unit length, to the side from which the corners run counter-clockwise."""
    front: Bool
    """bool: whether the ray comes from that side."""


@dataclass(frozen=True)
class RefitReport:
    """What a refit has made of a hierarchy."""

    cost_ratio: float
    """What a random ray is expected to cost, over what it cost when built. Above 1.2 a new build is worth a thought."""
    rebuilt: bool
    """Whether the hierarchy was built anew, because a triangle that it does not hold has an area now."""


@dataclass(frozen=True)
class Statistics:
    """What a build made, and what it cost."""

    triangles: int
    """In the meshes given."""
    degenerate_triangles: int
    """Of these, left out because they have no area."""
    non_finite_triangles: int
    """Left out by `skip_non_finite`."""
    degenerate_by_rounding: int
    """Of the degenerate triangles, those that have an area in float64."""
    references: int
    """Triangles in leaves, each counted once per leaf."""
    nodes: int
    """Inner nodes and leaves of the structure that is traced."""
    bytes: int
    """Of the structure that is traced, triangles included."""
    build_peak_bytes: int
    """The maximum number of bytes that the build held at once; 0 for a hierarchy from a file."""
    build_seconds: float
    """From arrays to a structure ready to trace; 0 for a hierarchy from a file."""


@dataclass(frozen=True)
class MeshStatistics:
    """What a hierarchy has of one of its meshes."""

    triangles: int
    """In the mesh given."""
    left_out: int
    """Of these, in no leaf: those that have no area."""
    references: int
    """Triangles in leaves, each counted once per leaf."""
    bounds: npt.NDArray[np.float64]
    """float64 (2, 3): the smallest and the largest coordinates of the triangles in leaves."""


@dataclass(frozen=True)
class Measures:
    """How good a tree is, and what it holds (docs/algorithms.md)."""

    sah: float
    """Surface area heuristic: the cost of a random line through the root."""
    epo: float
    """End-point overlap: the cost, over a random point of the surface, of nodes that hold it without need."""
    lcv: float
    """Leaf count variability: the standard deviation of the number of leaves that a random line meets."""
    references: int
    """Triangles in leaves, each counted once per leaf."""
    nodes: int
    """Inner nodes and leaves."""
    leaves: int
    """Leaves alone."""
    depth: int
    """Of the leaf farthest from the root; 0 where the root is a leaf."""


def hits_of(records: npt.NDArray[Any]) -> Hits:
    return Hits(*(records[name] for name in ("t", "u", "v", "primitive", "mesh")))


def scene_hits_of(records: npt.NDArray[Any]) -> SceneHits:
    return SceneHits(*(records[name] for name in ("t", "u", "v", "primitive", "mesh", "instance")))


def primitives_of(records: npt.NDArray[Any]) -> Primitives:
    return Primitives(records["primitive"], records["mesh"])


def scene_primitives_of(records: npt.NDArray[Any]) -> ScenePrimitives:
    return ScenePrimitives(records["primitive"], records["mesh"], records["instance"])


def offsets_of(data: UInt8) -> Int64:
    return data.view(np.int64)
