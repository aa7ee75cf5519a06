"""Hierarchies in the memory of an NVIDIA GPU, for arrays that lie there: of CuPy, PyTorch, JAX or Numba.

    bvh = kerf_bvh.cuda.Bvh(kerf_bvh.Bvh(vertices, faces))
    hits = bvh.intersect(rays)
    t = cupy.asarray(hits.t)

Every answer is bit for bit that of `kerf_bvh.Bvh`.

Arrays are whatever has `__dlpack__` or `__cuda_array_interface__`, and are read and written where they lie. Types,
shapes and places are checked, never converted.

A call starts its work on `stream`, and waits for nothing unless it says so. `stream` is a stream of CuPy, PyTorch or
Numba, anything with `__cuda_stream__`, or an address; None is the default stream of the device, which in PyTorch and
CuPy is the current one unless another was chosen. Through DLPack, what the owner of an array did to it before on its
current stream comes first; so does what an interface with an entry `stream` tells. The same holds for who takes
answers that kerf made. Two things are the caller's: what reads an `out` of another library on another stream has to
wait, and memory that `stream` still reads must not be given back on another one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypedDict, TypeVar, Unpack

import numpy as np
import numpy.typing as npt

from . import _kerf
from ._arrays import Float64, array_of
from ._bvh import Bvh as HostBvh
from ._results import HIT, SURFACE_POINT, hits_of
from ._results import Hits as HostHits
from ._results import Lists as HostLists
from ._results import SurfacePoints as HostSurfacePoints

if not hasattr(_kerf, "CudaBvh"):
    raise ImportError(
        "kerf_bvh.cuda: this kerf_bvh was built without CUDA; in a clone of kerf, with the CUDA Toolkit: "
        "pip install . -C cmake.define.KERF_BINDINGS_CUDA=ON",
        name=__name__,
    )

Error = _kerf.CudaError

Array = Any
"""An array of a device, of any library: it has `__dlpack__` or `__cuda_array_interface__`."""

Stream = Any
"""A stream of any library, an address, or None."""

Out = TypeVar("Out")


class BuildOptions(TypedDict, total=False):
    """How to build on the device."""

    max_reference_ratio: float
    """In [1, 16], 1.5: at most so many references per triangle, whose memory is taken beforehand."""
    max_leaf_size: int
    """In [1, 8], 8: at most so many references in a leaf."""
    radius: int
    """In [1, 64], 8: how many neighbours to either side are looked at before two clusters merge."""


@dataclass(frozen=True)
class Statistics:
    """What a hierarchy on the device is."""

    triangles: int
    """In the meshes given."""
    degenerate_triangles: int
    """Of these, left out because they have no area; 0 for a copy."""
    references: int
    """Triangles in leaves, each counted once per leaf."""
    nodes: int
    """Of two children each."""
    bytes: int
    """Of the device's memory."""
    scratch_bytes: int
    """That the build held besides; 0 for a copy."""
    cost: float
    """Of the surface area heuristic; 0 for a copy."""


class DeviceArray:
    """An array that kerf made on a device, of one dimension or two.

    `cupy.asarray`, `torch.from_dlpack` and `numba.cuda.as_cuda_array` take it without a copy. It holds its memory as
    long as it or what they made of it is there; to give that back waits for all work of the device.
    """

    __slots__ = ("_memory", "_offset", "_shape", "_strides", "_dtype", "_stream")

    def __init__(
        self,
        memory: _kerf.CudaMemory,
        offset: int,
        shape: tuple[int, ...],
        row_bytes: int,
        dtype: npt.DTypeLike,
        stream: Stream = None,
    ) -> None:
        """Not for users: rows that begin `row_bytes` after one another."""
        self._memory, self._offset, self._shape, self._dtype = memory, offset, shape, np.dtype(dtype)
        self._strides = (row_bytes, self._dtype.itemsize)[: len(shape)]
        self._stream = stream  # which the interface names, and which therefore has to live on

    @property
    def shape(self) -> tuple[int, ...]:
        return self._shape

    @property
    def strides(self) -> tuple[int, ...]:
        """In bytes."""
        return self._strides

    @property
    def dtype(self) -> np.dtype[Any]:
        return self._dtype

    @property
    def device(self) -> int:
        """The number of the device."""
        return self._memory.device

    def __len__(self) -> int:
        return self._shape[0]

    def __repr__(self) -> str:
        return f"<kerf_bvh.cuda.DeviceArray of {self._dtype}, shape {self._shape}, on device {self.device}>"

    def get(self) -> npt.NDArray[Any]:
        """A copy on the host. Waits until the array is written."""
        array = np.empty(self._shape, self._dtype)
        width = array.itemsize * math.prod(self._shape[1:])
        self._memory.fetch(self._offset, self._strides[0], width, array.reshape(-1).view(np.uint8))
        return array

    def __dlpack_device__(self) -> tuple[int, int]:
        return 2, self.device  # CUDA

    def __dlpack__(
        self,
        *,
        stream: int | None = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> object:
        """A capsule of DLPack. What `stream` does from here on comes after what wrote the array."""
        if copy or dl_device is not None and tuple(dl_device) != self.__dlpack_device__():
            raise BufferError(f"it lies on CUDA device {self.device}; get() copies it to the host")
        if stream == 0:
            raise ValueError("stream: 0 may be any of two; the default stream is 1")
        if stream != -1:
            self._memory.make_wait(1 if stream is None else int(stream))
        size = self._dtype.itemsize
        return self._memory.capsule(
            self._offset,
            list(self._shape),
            [stride // size for stride in self._strides],
            {"i": 0, "u": 1, "f": 2, "b": 6}[self._dtype.kind],
            8 * size,
            max_version is not None and max_version[0] >= 1,
        )

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        """Version 3. Who reads it orders what it does after `stream`, which is None once the array is written."""
        size = math.prod(self._shape)
        return {
            "shape": self._shape,
            "typestr": self._dtype.str,
            "data": (self._memory.address + self._offset if size else 0, False),
            "strides": self._strides,
            "stream": None if self._memory.is_written() else stream_number(self._stream) or 1,
            "version": 3,
        }


class _Records:
    """Places on triangles: rows of numbers on a device, some of them floats, some integers."""

    __slots__ = ("rows",)
    _record: np.dtype[Any]

    def __init__(self, rows: DeviceArray) -> None:
        self.rows = rows
        """(n, columns), of float32; the columns of integers hold bits of these."""

    def __len__(self) -> int:
        return len(self.rows)

    def _column(self, name: str) -> DeviceArray:
        """A view of the rows."""
        assert self._record.fields is not None
        dtype, offset = self._record.fields[name][:2]
        rows = self.rows
        shape = (len(rows), *dtype.shape)
        return DeviceArray(rows._memory, rows._offset + offset, shape, self._record.itemsize, dtype.base, rows._stream)

    def _fetch(self) -> npt.NDArray[Any]:
        return self.rows.get().view(self._record).reshape(-1)

    @property
    def u(self) -> DeviceArray:
        """float32: weight of v1; 0 where there is none."""
        return self._column("u")

    @property
    def v(self) -> DeviceArray:
        """float32: weight of v2; 0 where there is none."""
        return self._column("v")

    @property
    def primitive(self) -> DeviceArray:
        """uint32: number of the triangle within its mesh; INVALID where there is none."""
        return self._column("primitive")

    @property
    def mesh(self) -> DeviceArray:
        """uint32: number of the mesh in the order given to the build; INVALID where there is none."""
        return self._column("mesh")


class Hits(_Records):
    """Where rays cross triangles, on the device: `kerf_bvh.Hits` says what the numbers are.

    Each is a view of `rows`, an array (n, 5) in which the five numbers of a hit lie beside each other.
    """

    __slots__ = ()
    _record = HIT

    @staticmethod
    def empty(count: int, device: int | None = None) -> Hits:
        """Memory for so many, with nothing in it yet, for `out=`."""
        return Hits(_empty(count, 5, device))

    @property
    def t(self) -> DeviceArray:
        """float32: distance in lengths of the direction; infinity for a miss."""
        return self._column("t")

    def get(self) -> HostHits:
        """A copy on the host. Waits until they are written."""
        return hits_of(self._fetch())


class SurfacePoints(_Records):
    """Closest points of triangles, on the device: `kerf_bvh.SurfacePoints` says what the numbers are.

    Each is a view of `rows`, an array (n, 8) in which the eight numbers of a point lie beside each other.
    """

    __slots__ = ()
    _record = SURFACE_POINT

    @staticmethod
    def empty(count: int, device: int | None = None) -> SurfacePoints:
        """Memory for so many, with nothing in it yet, for `out=`."""
        return SurfacePoints(_empty(count, 8, device))

    @property
    def position(self) -> DeviceArray:
        """float32 (n, 3): the point itself."""
        return self._column("position")

    @property
    def distance(self) -> DeviceArray:
        """float32: from the given point; infinity where there is none."""
        return self._column("distance")

    def get(self) -> HostSurfacePoints:
        """A copy on the host. Waits until they are written."""
        records = self._fetch()
        return HostSurfacePoints(*(records[name] for name in SURFACE_POINT.names or ()))


class Lists:
    """A list of hits for each of many rays, one list after the other, on the device."""

    __slots__ = ("offsets", "items")

    def __init__(self, offsets: DeviceArray, items: Hits) -> None:
        self.offsets = offsets
        """int64 (n + 1): where each list begins in `items`; one more ends the last."""
        self.items = items
        """All hits, in the order of the rays."""

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def get(self) -> HostLists[HostHits]:
        """A copy on the host. Waits until they are written."""
        return HostLists(self.offsets.get(), self.items.get())


class Bvh:
    """A split bounding volume hierarchy in the memory of a device, ready to trace.

    Calls take arrays of the same device: rays (n, 8) of float32, whose numbers are origin, direction, t_min and
    t_max, or their parts, as `rays` takes them; points (n, 3) of float32. Answers are arrays that kerf makes, or that
    the caller gives as `out`, which are then returned. With `out`, a call takes no memory and may be captured into a
    CUDA graph. Any number of threads and streams may ask at once.

    Coordinates are float32, as the hierarchy has them: for one that was built of float64 vertices on the CPU, those of
    the meshes less `origin`.

    Errors: ValueError and TypeError, which begin with the name of the array; `Error` where CUDA reports one.
    """

    __slots__ = ("_bvh", "_origin")

    def __init__(self, bvh: HostBvh | None = None, *, device: int | None = None, local: bool = False) -> None:
        """Copies a hierarchy of the CPU to the device, the current one unless `device` says which. Waits.

        bvh: None for a hierarchy of nothing, which every ray misses.
        local: True takes one whose `origin` is not 0, because it was built of float64 vertices. All coordinates here
            are then those less `origin`. False refuses it.
        """
        self._origin = np.zeros(3)
        if bvh is None:
            self._bvh = _kerf.CudaBvh()
            return
        if not isinstance(bvh, HostBvh):
            raise TypeError(f"bvh: {type(bvh).__name__}, where a kerf_bvh.Bvh is needed; Bvh.build takes arrays")
        if bvh.origin.any() and not local:
            raise ValueError(
                f"bvh: built of float64 vertices, in a frame at {bvh.origin.tolist()}; build it of float32 vertices, "
                "or say local=True and give coordinates less that"
            )
        self._bvh, self._origin = _kerf.cuda_upload(bvh._bvh, device), bvh.origin

    @classmethod
    def build(cls, vertices: Array, faces: Array, *, stream: Stream = None, **options: Unpack[BuildOptions]) -> Bvh:
        """Builds the hierarchy of one mesh on the device where its arrays lie. Waits until that is done.

        vertices: (n, 3) of float32; faces: (t, 3) of uint32 or int32. Rows may have gaps between them. The arrays may
            change afterwards.
        options: see `BuildOptions`; what memory is taken, `build_bytes` tells.

        Raises `Error` for numbers of vertices that are not there, vertices that are not finite, and too little memory.
        """
        return cls._build([(vertices, faces)], [""], stream, **options)

    @classmethod
    def from_meshes(
        cls, meshes: Sequence[tuple[Array, Array]], *, stream: Stream = None, **options: Unpack[BuildOptions]
    ) -> Bvh:
        """Builds one hierarchy over several meshes. Answers name a mesh by its place in `meshes`."""
        return cls._build(meshes, _names(meshes), stream, **options)

    @classmethod
    def _build(
        cls,
        meshes: Sequence[tuple[Array, Array]],
        names: list[str],
        stream: Stream,
        max_reference_ratio: float = 1.5,
        max_leaf_size: int = 8,
        radius: int = 8,
    ) -> Bvh:
        made = cls.__new__(cls)
        vertices, faces = [list(part) for part in zip(*meshes)] or ([], [])
        made._bvh = _kerf.cuda_build(
            vertices, faces, names, max_reference_ratio, max_leaf_size, radius, stream_number(stream)
        )
        made._origin = np.zeros(3)
        return made

    def refit(self, vertices: Array, faces: Array, *, stream: Stream = None) -> None:
        """Moves the triangles to where they are now, on `stream`: what is asked there later sees them moved.

        vertices, faces: of as many triangles as were built, as `build` takes them. Every answer is exact, but where
        many triangles were split, a new build is faster to trace.
        """
        self._refit([(vertices, faces)], [""], stream)

    def refit_meshes(self, meshes: Sequence[tuple[Array, Array]], *, stream: Stream = None) -> None:
        """The same for as many meshes as were built, as `from_meshes` takes them."""
        self._refit(meshes, _names(meshes), stream)

    def _refit(self, meshes: Sequence[tuple[Array, Array]], names: list[str], stream: Stream) -> None:
        vertices, faces = [list(part) for part in zip(*meshes)] or ([], [])
        _kerf.cuda_refit(self._bvh, vertices, faces, names, stream_number(stream))

    # Rays

    def intersect(
        self,
        origins: Array,
        directions: Array | None = None,
        t_min: Array = 0.0,
        t_max: Array = math.inf,
        *,
        out: Out | None = None,
        stream: Stream = None,
    ) -> Hits | Out:
        """The closest hit of each ray in [t_min, t_max]. Of several at the same t, the lowest mesh and triangle.

        origins: rays (n, 8), or with `directions` origins, as `rays` takes these and what follows.
        out: `Hits`, as `Hits.empty(n)` makes them, or an array (n, 5) of any type of 32 bits.

        Returns `Hits`, or `out`.
        """
        given = _rays(origins, directions, t_min, t_max)
        made = _kerf.cuda_intersect(self._bvh, given, _rows(out), number := stream_number(stream))
        return _given(out, number) if made is None else Hits(_array(made, (5,), np.float32, stream))

    def occluded(
        self,
        origins: Array,
        directions: Array | None = None,
        t_min: Array = 0.0,
        t_max: Array = math.inf,
        *,
        out: Out | None = None,
        stream: Stream = None,
    ) -> DeviceArray | Out:
        """Whether each ray hits anything in [t_min, t_max]: bool (n). Sooner than `intersect`; as that.

        out: (n) of bool or of integers of 8 bits.
        """
        given = _rays(origins, directions, t_min, t_max)
        made = _kerf.cuda_occluded(self._bvh, given, out, number := stream_number(stream))
        return _given(out, number) if made is None else _array(made, (), np.bool_, stream)

    def count_hits(
        self,
        origins: Array,
        directions: Array | None = None,
        t_min: Array = 0.0,
        t_max: Array = math.inf,
        *,
        out: Out | None = None,
        stream: Stream = None,
    ) -> DeviceArray | Out:
        """How many triangles each ray crosses in [t_min, t_max]: uint32 (n).

        out: (n) of integers of 32 bits.
        """
        given = _rays(origins, directions, t_min, t_max)
        made = _kerf.cuda_count_hits(self._bvh, given, out, number := stream_number(stream))
        return _given(out, number) if made is None else _array(made, (), np.uint32, stream)

    def all_hits(
        self,
        origins: Array,
        directions: Array | None = None,
        t_min: Array = 0.0,
        t_max: Array = math.inf,
        *,
        stream: Stream = None,
    ) -> Lists:
        """Every triangle that each ray crosses in [t_min, t_max], once each, in the order of (t, mesh, primitive).

        As `kerf_bvh.Bvh.all_hits`. Waits for the number of all hits, whose memory it takes; `count_hits` and
        `list_hits` do the same without waiting.
        """
        given = _rays(origins, directions, t_min, t_max)
        offsets, items, *counts = _kerf.cuda_all_hits(self._bvh, given, stream_number(stream))
        return Lists(
            DeviceArray(offsets, 0, (counts[0],), 8, np.int64, stream),
            Hits(DeviceArray(items, 0, (counts[1], 5), 20, np.float32, stream)),
        )

    def list_hits(
        self,
        origins: Array,
        directions: Array | None = None,
        t_min: Array = 0.0,
        t_max: Array = math.inf,
        *,
        offsets: Array,
        out: Out,
        stream: Stream = None,
    ) -> Out:
        """The first `offsets[i + 1] - offsets[i]` hits of each ray, from `out[offsets[i]]` on; misses where there are
        fewer.

        offsets: (n + 1) of integers of 64 bits, the sums of `count_hits` before each ray, or multiples of as many hits
            as are wanted.
        out: `Hits`, or an array (h, 5) of any type of 32 bits, where h is at least the last of `offsets`, which is
            not checked.
        """
        given = _rays(origins, directions, t_min, t_max)
        _kerf.cuda_list_hits(self._bvh, given, offsets, _rows(out), number := stream_number(stream))
        return _written(out, number)

    # Points

    def contains(self, points: Array, *, out: Out | None = None, stream: Stream = None) -> DeviceArray | Out:
        """Whether points lie inside the closed surface that the triangles make, or on it: bool (n).

        points: (n, 3). out: (n) of bool or of integers of 8 bits.
        """
        made = _kerf.cuda_contains(self._bvh, points, out, number := stream_number(stream))
        return _given(out, number) if made is None else _array(made, (), np.bool_, stream)

    def closest_point(
        self, points: Array, max_distance: float = math.inf, *, out: Out | None = None, stream: Stream = None
    ) -> SurfacePoints | Out:
        """The closest point of any triangle within `max_distance` (included), for each point.

        points: (n, 3). out: `SurfacePoints`, as `SurfacePoints.empty(n)` makes them, or an array (n, 8) of any type of
        32 bits. Returns `SurfacePoints`, or `out`.
        """
        rows, number = _rows(out), stream_number(stream)
        made = _kerf.cuda_closest_point(self._bvh, points, max_distance, rows, number)
        return _given(out, number) if made is None else SurfacePoints(_array(made, (8,), np.float32, stream))

    def signed_distance(self, points: Array, *, out: Out | None = None, stream: Stream = None) -> DeviceArray | Out:
        """The distance to the closest point of a closed surface, negative inside: float32 (n).

        points: (n, 3). out: (n) of float32. Infinity for a hierarchy of nothing.
        """
        made = _kerf.cuda_signed_distance(self._bvh, points, out, number := stream_number(stream))
        return _given(out, number) if made is None else _array(made, (), np.float32, stream)

    # What it is

    @property
    def device(self) -> int:
        """The number of the device that it is on."""
        return self._bvh.device

    @property
    def origin(self) -> Float64:
        """float64 (3,): where the frame of all coordinates lies; 0 unless `local` took another."""
        return self._origin.copy()

    @property
    def bounds(self) -> Float64 | None:
        """float64 (2, 3): the smallest and the largest coordinates; None without triangles. Waits for the device."""
        array = np.array(self._bvh.bounds())
        return array if (array[0] <= array[1]).all() else None

    @property
    def statistics(self) -> Statistics:
        return Statistics(*self._bvh.statistics())

    def __repr__(self) -> str:
        made = self.statistics
        return f"<kerf_bvh.cuda.Bvh of {made.triangles} triangles, {made.bytes} bytes, device {self.device}>"


def rays(
    origins: Array,
    directions: Array,
    t_min: Array = 0.0,
    t_max: Array = math.inf,
    *,
    out: Out | None = None,
    stream: Stream = None,
) -> DeviceArray | Out:
    """Rays (n, 8) of float32 from their parts, for calls that trace them more than once.

    origins, directions: (n, 3) of float32, rows may have gaps between them; or three numbers that all rays share, of
        the host. One of the two lies on the device.
    t_min, t_max: (n) of float32; or one number of the host.
    out: (n, 8) of float32, returned then.
    """
    given, number = _rays(origins, directions, t_min, t_max), stream_number(stream)
    made = _kerf.cuda_rays(given, out, None, number)
    return _given(out, number) if made is None else _array(made, (8,), np.float32, stream)


def build_bytes(triangles: int, *, max_reference_ratio: float = 1.5, max_leaf_size: int = 8, radius: int = 8) -> int:
    """The most bytes of the device's memory that `Bvh.build` of so many triangles holds at once."""
    if triangles < 0:
        raise ValueError(f"triangles: {triangles}, where a number from 0 is needed")
    return _kerf.cuda_build_bytes(triangles, max_reference_ratio, max_leaf_size, radius)


def stream_number(stream: Stream) -> int:
    """The address of a stream of any library, 0 for the default stream."""
    if stream is None:
        return 0
    if isinstance(stream, int) and not isinstance(stream, bool):
        if stream < 0:
            raise ValueError(f"stream: {stream} is no stream")
        return 0 if stream == 1 else stream  # DLPack's number of the default stream
    for name in ("__cuda_stream__", "cuda_stream", "ptr", "handle"):  # the protocol; PyTorch, CuPy, Numba
        value = getattr(stream, name, None)
        if callable(value):
            value = value()
        if isinstance(value, tuple) and len(value) == 2:
            value = value[1]  # behind the version of the protocol
        value = getattr(value, "value", value)  # of ctypes
        if isinstance(value, int):
            return stream_number(value)
        if value is None and name == "handle" and hasattr(stream, name):
            return 0
    raise TypeError(f"stream: {type(stream).__name__} is no stream of CUDA, and has no __cuda_stream__")


def _names(meshes: Sequence[tuple[Array, Array]]) -> list[str]:
    if not isinstance(meshes, Sequence) or not all(isinstance(mesh, tuple) and len(mesh) == 2 for mesh in meshes):
        raise TypeError("meshes: a list of tuples of vertices and faces is needed")
    return [f"mesh {i}: " for i in range(len(meshes))]


def _rays(origins: Array, directions: Array | None, t_min: Array, t_max: Array) -> Any:
    """Rows as they are, or the parts of rays with what all of them share as tuples and floats."""
    if directions is None:
        if not (isinstance(t_min, (int, float)) and t_min == 0 and isinstance(t_max, float) and t_max == math.inf):
            raise ValueError("t_min, t_max: given beside rays, whose rows hold them")
        if isinstance(origins, tuple):
            raise TypeError("rays: a tuple, where an array of a device is needed; its parts are arguments")
        return origins
    return (
        _shared(origins, "origins", (3,)),
        _shared(directions, "directions", (3,)),
        _shared(t_min, "t_min", ()),
        _shared(t_max, "t_max", ()),
    )


def _shared(value: Any, name: str, shape: tuple[int, ...]) -> Any:
    """Numbers of the host that all rays share, as a tuple or a float; else the value, an array of a device."""
    if not isinstance(value, (int, float, list, tuple, np.ndarray, np.generic)):
        return value
    array = array_of(value, name)
    if array.shape != shape:
        raise ValueError(f"{name}: shape {array.shape} on the host, where {shape} or an array of a device is needed")
    return tuple(float(number) for number in array) if shape else float(array)


def _rows(out: Any) -> Any:
    """The array that an `out` of kerf's consists of; else the caller's array."""
    return out.rows if isinstance(out, _Records) else out


def _given(out: Out | None, stream: int) -> Out:
    """The `out` of a call that made nothing."""
    assert out is not None
    return _written(out, stream)


def _written(out: Out, stream: int) -> Out:
    """`out`; who takes it, if it is kerf's, waits for what `stream` has been told by now."""
    rows = _rows(out)
    if isinstance(rows, DeviceArray):
        rows._memory.mark_written(stream)
    return out


def _array(
    made: tuple[_kerf.CudaMemory, int], columns: tuple[int, ...], dtype: npt.DTypeLike, stream: Stream
) -> DeviceArray:
    """What a call made: so many rows of that many columns."""
    memory, count = made
    return DeviceArray(memory, 0, (count, *columns), math.prod(columns) * np.dtype(dtype).itemsize, dtype, stream)


def _empty(count: int, columns: int, device: int | None) -> DeviceArray:
    if count < 0:
        raise ValueError(f"count: {count}, where a number from 0 is needed")
    return _array((_kerf.cuda_allocate(4 * count * columns, device), count), (columns,), np.float32, None)
