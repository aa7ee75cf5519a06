"""Meshes, and answers by brute force in rationals."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

CUBE_VERTICES = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], np.float32
)
CUBE_FACES = np.array(
    [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
     [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]], np.uint32
)  # fmt: skip


def sphere(rings=24, segments=32, radius=1.0):
    """A closed surface around the origin, its faces turned outwards."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1]
    around = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    grid = np.stack(
        [np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)),
         np.outer(np.cos(polar), np.ones(segments))], axis=-1
    )  # fmt: skip
    vertices = np.vstack([grid.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]) * radius
    faces = []
    top, bottom = len(vertices) - 2, len(vertices) - 1
    for j in range(segments):
        k = (j + 1) % segments
        faces.append([top, j, k])
        faces.append([bottom, (rings - 2) * segments + k, (rings - 2) * segments + j])
        for i in range(rings - 2):
            a, b, c, d = i * segments + j, i * segments + k, (i + 1) * segments + j, (i + 1) * segments + k
            faces += [[a, c, b], [b, c, d]]
    return vertices, np.array(faces)


class OnlyDlpack:
    """An array of another library, which offers nothing but DLPack."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **arguments):
        return self.array.__dlpack__(**arguments)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def exact(points):
    """Arrays of floats as nested lists of fractions."""
    return [[Fraction(float(x)) for x in point] for point in points]


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def crossing(origin, direction, triangle):
    """t at which the line meets the closed triangle, exactly; None if it does not, or lies in its plane."""
    v0, v1, v2 = triangle
    normal = cross(subtract(v1, v0), subtract(v2, v0))
    along = dot(normal, direction)
    if along == 0:
        return None
    t = dot(normal, subtract(v0, origin)) / along
    point = [o + t * d for o, d in zip(origin, direction)]
    for a, b in ((v0, v1), (v1, v2), (v2, v0)):
        if dot(cross(subtract(b, a), subtract(point, a)), normal) < 0:
            return None
    return t


def squared_distance(point, triangle):
    """The squared distance of a point from a triangle, exactly."""
    v0, v1, v2 = triangle
    normal = cross(subtract(v1, v0), subtract(v2, v0))
    edges = ((v0, v1), (v1, v2), (v2, v0))
    if all(dot(cross(subtract(b, a), subtract(point, a)), normal) >= 0 for a, b in edges):
        return dot(normal, subtract(point, v0)) ** 2 / dot(normal, normal)
    distances = []
    for a, b in edges:
        edge = subtract(b, a)
        s = max(Fraction(0), min(Fraction(1), dot(subtract(point, a), edge) / dot(edge, edge)))
        apart = subtract(point, [x + s * e for x, e in zip(a, edge)])
        distances.append(dot(apart, apart))
    return min(distances)
