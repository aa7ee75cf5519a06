"""Scenes: many places for few hierarchies."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

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
    numbers_of,
    rounded,
    rows_of,
    triples_of,
)
from ._bvh import Bvh, readable
from ._questions import ALL, affine_of, boxes_of, check_threads, mask_of, rays_of
from ._results import (
    SCENE_HIT,
    SCENE_POINT,
    SCENE_PRIMITIVE,
    Geometry,
    Lists,
    SceneHits,
    ScenePoints,
    ScenePrimitives,
    SceneTouchingPairs,
    offsets_of,
    scene_hits_of,
    scene_primitives_of,
)


class Scene:
    """A hierarchy over instances: objects, which are `Bvh`s or scenes, at places. Nothing of an object is copied.

    It never changes: any number of threads may make any call at the same time. Every call releases Python's lock
    and runs on all cores, or on as many threads as `threads=` says. Arrays, shapes and errors are those of `Bvh`.

    A ray is taken to an object's space in double precision and rounded there to floats once, so that an instance
    is as watertight as its object. Questions are in the coordinates of the scene, rounded to float32.
    """

    __slots__ = ("_scene", "_objects", "_which", "_transforms", "_masks", "_numbers")

    def __init__(
        self,
        objects: Bvh | Scene | Sequence[Bvh | Scene] = (),
        transforms: ArrayLike | None = None,
        *,
        which: ArrayLike | None = None,
        masks: ArrayLike = ALL,
        numbers: ArrayLike = 0,
        threads: int = 0,
    ) -> None:
        """Builds the top level only, whatever the objects hold.

        objects: one that stands at all places; or one for each; or, with `which`, those that there are.
        transforms: (n, 3, 4) or (n, 4, 4), or one (3, 4) or (4, 4) for all: affine maps from the coordinates of the
            objects' meshes to those of the scene, invertible, with scale and shear. None leaves objects where they are.
        which: integers (n,): the place in `objects` of what stands at each instance.
        masks: 32 bits for each, or one for all: rays that are traced with a `mask` see an instance if they share a
            bit, and a mesh in it if they share one with that as well.
        numbers: integers of 32 bits, the caller's own: `scene.numbers[hits.instance]`.

        A `Bvh` that is refitted later stays in the scene as it was; a new scene takes it as it is then.
        Raises ValueError (shapes, ranges, transforms that cannot be inverted), TypeError, MemoryError.
        """
        kinds = [objects] if isinstance(objects, (Bvh, Scene)) else list(objects)
        for kind in kinds:
            if not isinstance(kind, (Bvh, Scene)):
                raise TypeError(f"objects: {type(kind).__name__}, where a Bvh or a Scene is needed")
        rows = affine_of(np.eye(4) if transforms is None else transforms, "transforms")
        places = None if which is None else array_of(which, "which")
        if places is not None and places.ndim != 1:
            raise ValueError(f"which: shape {places.shape}, where (n,) is needed")
        if rows.ndim == 3:
            count = len(rows)
        elif places is not None:
            count = len(places)
        else:
            count = len(kinds)
        if places is None:
            if len(kinds) not in (1, count):
                raise ValueError(f"objects: {len(kinds)} of them for {count} transforms")
            places = np.zeros(count, np.uint32) if len(kinds) == 1 else np.arange(count, dtype=np.uint32)
        chosen = numbers_of(places, "which", (count,), np.uint32)
        if count != 0 and int(chosen.max(initial=0)) >= len(kinds):
            raise ValueError(f"which: {int(chosen.max())}, but there are only {len(kinds)} objects")

        self._set(
            kinds,
            np.array(chosen),
            np.array(np.broadcast_to(rows, (count, 3, 4)), order="C"),
            np.array(numbers_of(masks, "masks", (count,), np.uint32)),
            np.array(numbers_of(numbers, "numbers", (count,), np.uint32)),
        )
        local = self._transforms + _frames(kinds, self._which, self._transforms)
        inner = [kind._bvh if isinstance(kind, Bvh) else kind._scene for kind in kinds]
        self._scene: _kerf.Scene = _kerf.build_scene(
            inner, self._which, local.reshape(-1), self._masks, self._numbers, check_threads(threads)
        )

    def _set(
        self, objects: Sequence[Bvh | Scene], which: UInt32, transforms: Float64, masks: UInt32, numbers: UInt32
    ) -> None:
        self._objects = tuple(objects)
        self._which, self._transforms, self._masks, self._numbers = which, transforms, masks, numbers
        for array in (which, transforms, masks, numbers):
            array.flags.writeable = False

    @classmethod
    def _of(cls, scene: _kerf.Scene, known: dict[int, Bvh | Scene]) -> Scene:
        """A scene of the library's. `known` has what stands in several scenes by its number."""
        kinds, identities, which, transforms, masks, numbers = scene.parts()
        for kind, identity in zip(kinds, identities):
            if identity not in known:
                known[identity] = Bvh._of(kind) if isinstance(kind, _kerf.Bvh) else cls._of(kind, known)
        objects = [known[identity] for identity in identities]
        local, places = transforms.view(np.float64).reshape(-1, 3, 4), which.view(np.uint32)
        new = cls.__new__(cls)
        new._set(
            objects, places, local - _frames(objects, places, local), masks.view(np.uint32), numbers.view(np.uint32)
        )
        new._scene = scene
        return new

    # Files

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a `.kerf` file, which holds each object once, however often it stands in the scene.

        Raises OSError, MemoryError.
        """
        self._scene.save(Path(path))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a file that `save` wrote; that of a `Bvh` is a scene of one instance. As `Bvh.load`."""
        return cls._of(_kerf.load_scene(readable(path)), {})

    @classmethod
    def map(cls, path: str | os.PathLike[str]) -> Scene:
        """As `load`, but the objects are mapped, as by `Bvh.map`."""
        return cls._of(_kerf.map_scene(readable(path)), {})

    def __reduce__(self) -> tuple[Callable[..., Scene], tuple[Any, ...]]:
        return _scene_of, (self._objects, self._transforms, self._which, self._masks, self._numbers)

    # Rays

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        mask: ArrayLike | None = None,
        accept: ArrayLike | None = None,
        accept_triangles: Mapping[Bvh, ArrayLike | Sequence[ArrayLike]] | None = None,
        threads: int = 0,
    ) -> SceneHits:
        """The closest hit of each ray in [t_min, t_max]. Of several at the same t, the lowest instance, mesh, triangle.

        accept: bool (`instance_count`,): False for instances that rays pass.
        accept_triangles: for objects with triangles that rays pass, wherever they stand: `{bvh: accept}`, of which
            each is what `Bvh.intersect` takes as its `accept`. Of other objects every triangle counts.

        Other parameters as those of `Bvh.intersect`. Returns `SceneHits` of shape (...).
        """
        rays, shape = rays_of(origins, directions, t_min, t_max, rounded)
        records = np.empty(shape, SCENE_HIT)
        data = records.reshape(-1).view(np.uint8)
        accepted = self._accepted(accept, accept_triangles)
        _kerf.scene_intersect(self._scene, *rays, mask_of(mask, shape), *accepted, data, check_threads(threads))
        return scene_hits_of(records)

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        mask: ArrayLike | None = None,
        accept: ArrayLike | None = None,
        accept_triangles: Mapping[Bvh, ArrayLike | Sequence[ArrayLike]] | None = None,
        threads: int = 0,
    ) -> Bool:
        """Whether each ray hits anything in [t_min, t_max]: bool (...). As `intersect`."""
        rays, shape = rays_of(origins, directions, t_min, t_max, rounded)
        answers = np.empty(shape, np.bool_)
        flags = answers.reshape(-1).view(np.uint8)
        accepted = self._accepted(accept, accept_triangles)
        _kerf.scene_occluded(self._scene, *rays, mask_of(mask, shape), *accepted, flags, check_threads(threads))
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
        """How many triangles each ray crosses in [t_min, t_max], each once for each instance: uint32 (...)."""
        rays, shape = rays_of(origins, directions, t_min, t_max, rounded)
        counts = np.empty(shape, np.uint32)
        _kerf.scene_count_hits(self._scene, *rays, counts.reshape(-1), check_threads(threads))
        return counts

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = math.inf,
        *,
        threads: int = 0,
    ) -> Lists[SceneHits]:
        """Every triangle of every instance that each ray crosses in [t_min, t_max], as `Bvh.all_hits`.

        In the order of (t, instance, mesh, primitive). Returns `Lists` of `SceneHits`, one list a ray.
        """
        rays, _ = rays_of(origins, directions, t_min, t_max, rounded)
        offsets, items = _kerf.scene_all_hits(self._scene, *rays, check_threads(threads))
        return Lists(offsets_of(offsets), scene_hits_of(items.view(SCENE_HIT)))

    def geometry(self, origins: ArrayLike, directions: ArrayLike, hits: SceneHits) -> Geometry:
        """What rays meet at their hits, as it stands in the scene: corners, normals, and whether the front is met.

        Normals are right under scale and shear, too; a mirrored object has its front where the moved corners run
        counter-clockwise. origins, directions: as they were given to the call that returned `hits`, of the same shape.
        """
        rays, shape = rays_of(origins, directions, 0.0, math.inf, rounded)
        if hits.t.shape != shape:
            raise ValueError(f"hits: shape {hits.t.shape}, where that of the rays is needed, {shape}")
        records = np.empty(shape, SCENE_HIT)
        for name in SCENE_HIT.names or ():
            records[name] = getattr(hits, name)
        corners = np.full((*shape, 3, 3), np.nan, np.float32)
        normals = np.full((*shape, 3), np.nan, np.float32)
        front = np.zeros(shape, np.bool_)
        data, flags = records.reshape(-1).view(np.uint8), front.reshape(-1).view(np.uint8)
        _kerf.scene_geometry(self._scene, *rays[:2], data, corners.reshape(-1), normals.reshape(-1), flags)
        return Geometry(corners, normals, front)

    # Points

    def side(self, points: ArrayLike, *, threads: int = 0) -> npt.NDArray[np.uint8]:
        """As `contains`, with the surface told from the inside: uint8 (...) of the values of `Side`."""
        local, shape = _points(points)
        sides = np.empty(shape, np.uint8)
        _kerf.scene_side(self._scene, local, sides.reshape(-1), check_threads(threads))
        return sides

    def contains(self, points: ArrayLike, *, threads: int = 0) -> Bool:
        """Whether points lie inside the closed surface that all triangles make, or on it: bool (...).

        By the parity of the crossings of one ray through all instances: in two that overlap is outside.
        """
        local, shape = _points(points)
        inside = np.empty(shape, np.bool_)
        _kerf.scene_contains(self._scene, local, inside.reshape(-1).view(np.uint8), check_threads(threads))
        return inside

    def signed_distance(self, points: ArrayLike, *, threads: int = 0) -> Float32:
        """The distance to the closest point of a closed surface, negative inside (`contains`): float32 (...)."""
        local, shape = _points(points)
        distances = np.empty(shape, np.float32)
        _kerf.scene_signed_distance(self._scene, local, distances.reshape(-1), check_threads(threads))
        return distances

    def closest_point(self, points: ArrayLike, max_distance: float = math.inf, *, threads: int = 0) -> ScenePoints:
        """The closest point of any triangle within `max_distance` (included), for each point.

        Distances are those in the scene, also under scale and shear. Of several at the same distance, the lowest
        instance, mesh and triangle. Returns `ScenePoints` of shape (...).
        """
        local, shape = _points(points)
        records = np.empty(shape, SCENE_POINT)
        data = records.reshape(-1).view(np.uint8)
        _kerf.scene_closest_point(self._scene, local, data, max_distance, check_threads(threads))
        return _scene_points(records, points)

    def nearest(
        self, points: ArrayLike, count: int, max_distance: float = math.inf, *, threads: int = 0
    ) -> Lists[ScenePoints]:
        """The closest points of the `count` triangles that are nearest to each point, nearest first.

        Fewer if not so many lie within `max_distance` (included). Each triangle of each instance once; of several at
        the same distance the lowest instance, mesh and triangle first. Returns `Lists`, one list a point.
        """
        if count < 0:
            raise ValueError(f"count: {count}, where a number from 0 is needed")
        local, _ = _points(points)
        offsets, items = _kerf.scene_nearest(self._scene, local, count, max_distance, check_threads(threads))
        return Lists(offsets_of(offsets), _scene_points(items.view(SCENE_POINT), points))

    def within(self, points: ArrayLike, radius: float, *, threads: int = 0) -> Lists[ScenePoints]:
        """The closest point of every triangle that has a point within `radius` (included), nearest first.

        Each triangle of each instance once. Returns `Lists`, one list a point.
        """
        local, _ = _points(points)
        offsets, items = _kerf.scene_within(self._scene, local, radius, check_threads(threads))
        return Lists(offsets_of(offsets), _scene_points(items.view(SCENE_POINT), points))

    # Boxes, other scenes

    def triangles_in(self, boxes: ArrayLike, *, threads: int = 0) -> Lists[ScenePrimitives]:
        """Every triangle that has a point in a box, once for each instance, ordered by (instance, mesh, primitive).

        boxes: (..., 2, 3), the smallest and the largest coordinates. The corners of triangles are moved to the scene
        in double precision and rounded to float32 once; for the triangles as they are then, and the box as it is in
        float32, the answer is exact. Touching counts. Returns `Lists`, one list a box.
        """
        corners = np.ascontiguousarray(rounded(boxes_of(boxes)))
        offsets, items = _kerf.scene_triangles_in(self._scene, corners.reshape(-1), check_threads(threads))
        return Lists(offsets_of(offsets), scene_primitives_of(items.view(SCENE_PRIMITIVE)))

    def touching_pairs(
        self, other: Scene | Bvh | None = None, transform: ArrayLike | None = None, *, threads: int = 0
    ) -> SceneTouchingPairs:
        """All pairs of a triangle of this scene and one of `other`, moved, that have a point in common.

        other: a scene; or a `Bvh`, whose triangles are of instance 0; or None: then of two instances of this scene,
            the lower one first.
        transform: (3, 4) or (4, 4), an affine map of the coordinates of `other`; None leaves it where it is.

        Touching counts. Each pair once for each pair of instances. Corners of the second are moved to the space of
        the first one's object in double precision and rounded to float32 there, each once; for the triangles as
        they are then, the answer is exact.
        """
        if other is None:
            if transform is not None:
                raise ValueError("transform: one for no other scene")
            pairs = _kerf.scene_own_touching_pairs(self._scene, check_threads(threads))
        else:
            rows = _one_map(transform)
            pairs = _kerf.scene_touching_pairs(self._scene, _as_scene(other), rows, check_threads(threads))
        records = pairs.view(np.dtype([("first", SCENE_PRIMITIVE), ("second", SCENE_PRIMITIVE)]))
        return SceneTouchingPairs(scene_primitives_of(records["first"]), scene_primitives_of(records["second"]))

    def touches(self, other: Scene | Bvh, transform: ArrayLike | None = None) -> bool:
        """Whether there is such a pair with `other`. Stops at the first that is found."""
        return _kerf.scene_touches(self._scene, _as_scene(other), _one_map(transform))

    def triangles(self, primitive: ArrayLike, mesh: ArrayLike = 0, instance: ArrayLike = 0) -> Float32:
        """The corners of triangles by their numbers, as they stand in the scene: float32 (..., 3, 3).

        primitive, mesh, instance: integers (...), as hits have them. NaN for triangles that are in no leaf, because
        they have no area, or do not exist.
        """
        given = {"primitive": primitive, "mesh": mesh, "instance": instance}
        ids = np.empty(np.broadcast_shapes(*(np.shape(value) for value in given.values())), SCENE_PRIMITIVE)
        for name, value in given.items():
            numbers = array_of(value, name)
            ids[name] = numbers_of(numbers, name, numbers.shape, np.uint32).reshape(numbers.shape)
        corners = np.full((*ids.shape, 3, 3), np.nan, np.float32)
        _kerf.scene_triangles(self._scene, ids.reshape(-1).view(np.uint8), corners.reshape(-1))
        return corners

    # What it is

    @property
    def objects(self) -> tuple[Bvh | Scene, ...]:
        """What stands in the scene, as it was given."""
        return self._objects

    @property
    def which(self) -> UInt32:
        """uint32 (n,): the place in `objects` of what stands at each instance."""
        return self._which

    @property
    def transforms(self) -> Float64:
        """float64 (n, 3, 4): from the coordinates of each object to those of the scene."""
        return self._transforms

    @property
    def masks(self) -> UInt32:
        """uint32 (n,): the bits that each instance shares with the rays that see it."""
        return self._masks

    @property
    def numbers(self) -> UInt32:
        """uint32 (n,): the caller's own."""
        return self._numbers

    @property
    def instance_count(self) -> int:
        """How many instances there are, those of scenes at places counted at each: hits number them 0 to this."""
        return self._scene.instance_count()

    def path(self, instance: int) -> tuple[int, ...]:
        """Which instance the number in a hit or a point stands for: its place here, then that in the scene there.

        One number where no scene stands in this one. Raises ValueError for one that is not below `instance_count`.
        """
        if not 0 <= instance <= ALL:
            raise ValueError(f"instance: {instance}, where a number below {self.instance_count} is needed")
        return self._scene.path(int(instance))

    @property
    def bounds(self) -> Float64 | None:
        """float64 (2, 3): a box around all instances, not tight; None for a scene without triangles."""
        box = np.array(self._scene.bounds())
        return box if (box[0] <= box[1]).all() else None

    @property
    def bytes(self) -> int:
        """Of the scene itself, without its objects."""
        return self._scene.bytes()

    def _accepted(
        self, accept: ArrayLike | None, of_objects: Mapping[Bvh, ArrayLike | Sequence[ArrayLike]] | None
    ) -> tuple[UInt8 | None, Int64 | None, Int64 | None, UInt8 | None]:
        instances = None
        if accept is not None:
            flags = np.ascontiguousarray(accept)
            if flags.dtype != np.bool_:
                raise TypeError(f"accept: elements of type {flags.dtype}, where bool is needed")
            if flags.shape != (self.instance_count,):
                raise ValueError(f"accept: shape {flags.shape} for {self.instance_count} instances")
            instances = flags.view(np.uint8)
        if not of_objects:
            return instances, None, None, None
        numbers: dict[Bvh, int] = {}
        standing = self._standing(numbers)
        starts = np.full(len(numbers), -1, np.int64)
        firsts, triangles, rows, size = [], [], 0, 0
        for bvh, given in of_objects.items():
            if bvh not in numbers:
                raise ValueError("accept_triangles: an object that does not stand in the scene")
            accepted, first_of_mesh = bvh._accepted_triangles(given)
            starts[numbers[bvh]] = rows
            firsts.append(first_of_mesh + size)
            triangles.append(accepted)
            rows, size = rows + len(first_of_mesh), size + len(accepted)
        return instances, starts[standing], np.concatenate(firsts), np.concatenate(triangles)

    def _standing(self, numbers: dict[Bvh, int]) -> Int64:
        """What stands at each instance, as its number in `numbers`, which grows by what is not in it."""
        inner = [
            kind._standing(numbers)
            if isinstance(kind, Scene)
            else np.array([numbers.setdefault(kind, len(numbers))], np.int64)
            for kind in self._objects
        ]
        if all(len(numbers_of_one) == 1 for numbers_of_one in inner):
            return np.concatenate([np.empty(0, np.int64), *inner])[self._which]
        return np.concatenate([np.empty(0, np.int64), *(inner[place] for place in self._which)])

    def __repr__(self) -> str:
        return f"<kerf_bvh.Scene of {self.instance_count} instances, {self.bytes} bytes>"


def _points(points: ArrayLike) -> tuple[Float32, tuple[int, ...]]:
    array = triples_of(points, "points")
    return rows_of(rounded(array.reshape(-1, 3))), array.shape[:-1]


def _scene_points(records: npt.NDArray[Any], points: ArrayLike) -> ScenePoints:
    position = records["position"].astype(triples_of(points, "points").dtype, copy=False)
    names = ("distance", "u", "v", "primitive", "mesh", "instance")
    return ScenePoints(position, *(records[name] for name in names))


def _as_scene(other: Scene | Bvh) -> _kerf.Scene:
    if not isinstance(other, (Bvh, Scene)):
        raise TypeError(f"other: {type(other).__name__}, where a Scene or a Bvh is needed")
    return (Scene(other) if isinstance(other, Bvh) else other)._scene


def _one_map(transform: ArrayLike | None) -> list[float]:
    rows = affine_of(np.eye(4) if transform is None else transform, "transform")
    if rows.ndim != 2:
        raise ValueError(f"transform: shape {rows.shape}, where (3, 4) or (4, 4) is needed")
    return [float(number) for number in rows.reshape(-1)]


def _frames(objects: Sequence[Bvh | Scene], which: UInt32, transforms: Float64) -> Float64:
    """What transforms of local frames have beyond those of the meshes' coordinates: where each origin goes."""
    beyond = np.zeros(transforms.shape)
    origins = np.array([kind.origin if isinstance(kind, Bvh) else np.zeros(3) for kind in objects]).reshape(-1, 3)
    if origins.any():
        beyond[:, :, 3] = np.einsum("nij,nj->ni", transforms[:, :, :3], origins[which])
    return beyond


def _scene_of(objects: Any, transforms: Any, which: Any, masks: Any, numbers: Any) -> Scene:
    return Scene(objects, transforms, which=which, masks=masks, numbers=numbers)
