"""What the examples share: meshes that need no file, and arrays as PNG files."""

import struct
import zlib

import numpy as np


def write_png(path, values):
    """Writes an array (rows, columns) of numbers from 0 to 1, dark to bright."""
    stops = np.array([[15, 12, 35], [70, 45, 115], [170, 75, 95], [240, 150, 75], [252, 243, 200]], float)
    place = np.clip(np.nan_to_num(np.asarray(values, float)), 0, 1) * (len(stops) - 1)
    below = np.minimum(place.astype(int), len(stops) - 2)
    part = (place - below)[..., None]
    pixels = (stops[below] * (1 - part) + stops[below + 1] * part + 0.5).astype(np.uint8)
    rows, columns = pixels.shape[:2]
    lines = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines, 9)))
        file.write(chunk(b"IEND", b""))


def torus(around=160, across=80, radius=1.0, thickness=0.42, wave=0.0):
    """A closed surface: vertices and faces of a torus about the z axis, its thickness in three waves around."""
    turn, tilt = (np.linspace(0, 2 * np.pi, count, endpoint=False) for count in (around, across))
    a, b = np.meshgrid(turn, tilt, indexing="ij")
    thickness = thickness * (1 + wave * np.sin(3 * a))
    out = radius + thickness * np.cos(b)
    vertices = np.stack([out * np.cos(a), out * np.sin(a), thickness * np.sin(b)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    k, m = (i + 1) % around, (j + 1) % across
    p, q, r, s = i * across + j, k * across + j, k * across + m, i * across + m
    return vertices.astype(np.float32), np.stack([p, q, r, p, r, s], axis=-1).reshape(-1, 3)


def terrain(n=200):
    """Hills over the unit square: vertices (n * n, 3), row after row, and faces."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    z = 0.1 * np.sin(9 * x) * np.cos(7 * y) + 0.03 * np.sin(31 * x + 2) * np.sin(27 * y)
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1)
    faces = np.concatenate([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)])
    return np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32), faces


def sphere_of_directions(count):
    """Directions (count, 3), evenly over the sphere."""
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    around = np.pi * (3 - 5**0.5) * np.arange(count)
    return np.stack([np.sqrt(1 - z * z) * np.cos(around), np.sqrt(1 - z * z) * np.sin(around), z], axis=-1)
