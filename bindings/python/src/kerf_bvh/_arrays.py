"""From whatever holds numbers to arrays as the extension module takes them, or one sentence that says why not."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Float32 = npt.NDArray[np.float32]
Float64 = npt.NDArray[np.float64]
UInt32 = npt.NDArray[np.uint32]
UInt8 = npt.NDArray[np.uint8]
Int64 = npt.NDArray[np.int64]
Bool = npt.NDArray[np.bool_]

# What NumPy takes for an array, or an object that hands out its memory through DLPack.
ArrayLike = Any


def array_of(value: ArrayLike, name: str) -> npt.NDArray[Any]:
    """`value` as an array of numbers, without a copy where it is one. Throws TypeError, ValueError."""
    if isinstance(value, np.ma.MaskedArray):
        if count := int(np.ma.getmaskarray(value).sum()):
            raise ValueError(f"{name}: {count} elements are masked; fill them in or leave them out")
        value = value.data
    if not isinstance(value, np.ndarray) and hasattr(value, "__dlpack__"):
        try:
            value = np.from_dlpack(value)
        except (BufferError, RuntimeError, TypeError, ValueError) as error:
            raise ValueError(f"{name}: its memory cannot be read from here ({error}); copy it to the host") from error
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: not an array ({error})") from error
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: elements of type {array.dtype}, where real numbers are needed")
    return array


def triples_of(value: ArrayLike, name: str) -> npt.NDArray[Any]:
    """An array of shape (..., 3): of float32 if it was one of at most that, else of float64."""
    array = array_of(value, name)
    if array.ndim == 1 and array.size == 0:
        array = array.reshape(0, 3)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name}: shape {array.shape}, where (..., 3) is needed")
    is_narrow = array.dtype.kind == "f" and array.dtype.itemsize <= 4
    array = array.astype(np.float32 if is_narrow else np.float64, copy=False)
    return array if is_aligned(array) else array.copy()


def is_aligned(array: npt.NDArray[Any]) -> bool:
    return array.flags.aligned and all(stride % array.itemsize == 0 for stride in array.strides)


def rows_of(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """An array of shape (n, 3) as rows whose numbers lie beside each other, each after the one before."""
    is_fine = is_aligned(array) and array.strides[1] == array.itemsize and array.strides[0] >= 3 * array.itemsize
    return array if is_fine or array.shape[0] == 0 and array.flags.c_contiguous else np.ascontiguousarray(array)


def rounded(array: npt.NDArray[Any]) -> Float32:
    """The nearest floats; infinity beyond their range."""
    if array.dtype == np.float32:
        return array
    with np.errstate(over="ignore"):
        return array.astype(np.float32)


def vertices_of(value: ArrayLike, name: str) -> npt.NDArray[Any]:
    """Vertices (n, 3), or triangles by their corners (t, 3, 3), as rows of float32 or float64."""
    array = triples_of(value, name)
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[1] != 3):
        raise ValueError(f"{name}: shape {array.shape}, where (n, 3) is needed")
    return rows_of(array.reshape(-1, 3))


def faces_of(value: ArrayLike | None, name: str, vertices: npt.NDArray[Any], is_soup: bool) -> npt.NDArray[Any]:
    """Vertex numbers (t, 3) as rows of 32 bits, or beside float64 vertices of 64 bits."""
    if value is None:
        if not is_soup:
            raise ValueError(f"{name}: none, which needs vertices of shape (t, 3, 3), the corners of each triangle")
        return np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3)
    array = array_of(value, name)
    if array.size == 0 and array.ndim == 1:
        array = np.empty((0, 3), np.uint32)
    if array.dtype.kind == "f":
        raise TypeError(f"{name}: elements of type {array.dtype}, where integers are needed")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: shape {array.shape}, where (t, 3) is needed")
    if array.dtype.kind == "i" and array.size != 0 and (smallest := array.min()) < 0:
        triangle = int(np.argmax((array < 0).any(axis=1)))
        raise ValueError(f"{name}: triangle {triangle} names vertex {smallest}, but numbers begin at 0")
    if array.dtype.itemsize == 8 and vertices.dtype == np.float64:
        return rows_of(array.astype(array.dtype.newbyteorder("="), copy=False))
    if array.dtype.itemsize == 8 and array.size != 0 and (largest := array.max()) >= len(vertices):
        triangle = int(np.argmax((array >= len(vertices)).any(axis=1)))
        raise ValueError(
            f"{name}: triangle {triangle} names vertex {largest}, but there are only {len(vertices)}"
        )
    return rows_of(array.astype(np.int32 if array.dtype.kind == "i" and array.itemsize == 4 else np.uint32, copy=False))


def numbers_of(value: ArrayLike, name: str, shape: tuple[int, ...], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """One number for each of many questions of that shape, flat; a single number stands for all (stride 0)."""
    array = array_of(value, name)
    if np.dtype(dtype).kind == "u":
        if array.dtype.kind == "f":
            raise TypeError(f"{name}: elements of type {array.dtype}, where integers are needed")
        if array.size != 0 and (array.min() < 0 or array.max() > np.iinfo(np.uint32).max):
            raise ValueError(f"{name}: numbers beyond 32 bits, where each is a set of 32 bits")
    with np.errstate(over="ignore"):
        array = array.astype(dtype, copy=False)
    if array.ndim == 0:
        return np.broadcast_to(array, (int(np.prod(shape, dtype=np.int64)),))
    if array.shape != shape:
        raise ValueError(f"{name}: shape {array.shape}, where one number or {shape} is needed")
    flat = array.reshape(-1)
    return flat if is_aligned(flat) else flat.copy()
