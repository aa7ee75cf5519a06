#!/usr/bin/env python3
"""Python's calls beside the same calls without Python, and beside Open3D and trimesh, by turns; the best of each.

    PYTHONPATH=build/release/bindings/python/package python bench/python_bench.py MESH [--c libkerf_c.so]
        [--rays N] [--queries N] [--threads N] [--rounds N]

- `intersect` of diffuse rays, beside kerf_intersect_many over the same arrays (--c), which is the call of C++ that
  takes spans. Hits must be the same. The rays begin where those of cameras inside the mesh end.
- `closest_point` of points in and around the mesh, beside Open3D's compute_closest_points and, of a hundredth of
  them, trimesh.proximity.closest_point.
- `contains` of the same points, where the mesh is closed, beside Open3D's compute_occupancy.

Open3D and trimesh are left out where they are not installed. The mesh is an .obj file.
"""

import argparse
import ctypes
import time

import numpy as np

import kerf_bvh


def read_obj(path):
    """Vertices and triangles, polygons as fans."""
    vertices, faces = [], []
    with open(path, encoding="latin-1") as file:
        for line in file:
            if line.startswith("v "):
                vertices.append([float(x) for x in line.split()[1:4]])
            elif line.startswith("f "):
                corners = [int(word.split("/")[0]) for word in line.split()[1:]]
                corners = [i - 1 if i > 0 else len(vertices) + i for i in corners]
                faces.extend([corners[0], corners[i], corners[i + 1]] for i in range(1, len(corners) - 1))
    return np.array(vertices, np.float32), np.array(faces, np.uint32)


def best(rounds, **calls):
    """The shortest time of each call in seconds, all made by turns, and what each returned last."""
    times, answers = {name: np.inf for name in calls}, {}
    for i in range(rounds):
        for name in sorted(calls, reverse=i % 2 == 1):
            answers.pop(name, None)
            begin = time.perf_counter()
            answers[name] = calls[name]()
            times[name] = min(times[name], time.perf_counter() - begin)
    return times, answers


def diffuse_rays(bvh, count, random):
    """From the surfaces that cameras inside the bounds see, in 8 x 8 tiles, cosine-distributed."""
    lower, upper = (np.array(corner) for corner in bvh.bounds)
    origins, directions = [], []
    while sum(map(len, origins)) < count:
        eye = lower + (upper - lower) * random.uniform(0.3, 0.7, 3)
        forward = random.normal(size=3) * [1, 0.3, 1]
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0, 1, 0])
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        y, x = np.mgrid[0:1024, 0:1024]
        tiled = [a.reshape(128, 8, 128, 8).transpose(0, 2, 1, 3).reshape(-1, 1) / 512 - 1 for a in (x, y)]
        toward = (forward + tiled[0] * right + tiled[1] * up).astype(np.float32)
        seen = bvh.intersect(eye.astype(np.float32), toward)
        hit = seen.hit
        normals = bvh.geometry(eye.astype(np.float32), toward, seen).normal[hit].astype(np.float64)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals /= np.where(length == 0, 1, length)
        normals *= -np.sign(np.sum(normals * toward[hit], axis=1, keepdims=True))
        ball = random.normal(size=normals.shape)
        ball /= np.linalg.norm(ball, axis=1, keepdims=True)
        origins.append((eye + toward[hit] * seen.t[hit, None] + 1e-4 * normals).astype(np.float32))
        directions.append((normals * 1.0001 + ball).astype(np.float32))
    return np.concatenate(origins)[:count].copy(), np.concatenate(directions)[:count].copy()


class InC:
    """kerf_intersect_many of the C library over NumPy's arrays."""

    class Mesh(ctypes.Structure):
        _fields_ = [("size", ctypes.c_size_t), ("vertices", ctypes.c_void_p), ("vertex_count", ctypes.c_size_t),
                    ("vertex_stride", ctypes.c_size_t), ("triangles", ctypes.c_void_p), ("count", ctypes.c_size_t),
                    ("stride", ctypes.c_size_t), ("mask", ctypes.c_uint32)]

    class Field(ctypes.Structure):
        _fields_ = [("data", ctypes.c_void_p), ("stride", ctypes.c_ssize_t)]

    class Rays(ctypes.Structure):
        pass

    class Hits(ctypes.Structure):
        pass

    class Options(ctypes.Structure):
        _fields_ = [("size", ctypes.c_size_t), ("threads", ctypes.c_uint32)]

    Rays._fields_ = [("size", ctypes.c_size_t), ("count", ctypes.c_size_t), ("origin", Field * 3),
                     ("direction", Field * 3), ("t_min", Field), ("t_max", Field), ("mask", Field)]
    Hits._fields_ = [("size", ctypes.c_size_t), ("count", ctypes.c_size_t)] + list(
        zip("tuvpm", (Field,) * 5)
    )

    def __init__(self, library, vertices, faces):
        self.library, self.handle = ctypes.CDLL(library), ctypes.c_void_p()
        mesh = self.Mesh(ctypes.sizeof(self.Mesh), vertices.ctypes.data, len(vertices), 0, faces.ctypes.data,
                         len(faces), 0, 0xFFFFFFFF)
        if self.library.kerf_build(ctypes.byref(mesh), ctypes.c_size_t(1), None, ctypes.byref(self.handle)) != 0:
            raise RuntimeError("kerf_build failed")

    def intersect(self, origins, directions, hits, threads):
        rays = self.Rays(ctypes.sizeof(self.Rays), len(origins))
        for array, fields in ((origins, rays.origin), (directions, rays.direction)):
            for i in range(3):
                fields[i] = self.Field(array.ctypes.data + 4 * i, 12)
        to = self.Hits(ctypes.sizeof(self.Hits), len(hits))
        for i, name in enumerate("tuvpm"):
            setattr(to, name, self.Field(hits.ctypes.data + 4 * i, 20))
        options = self.Options(ctypes.sizeof(self.Options), threads)
        if self.library.kerf_intersect_many(self.handle, ctypes.byref(rays), ctypes.byref(to), ctypes.byref(options)):
            raise RuntimeError("kerf_intersect_many failed")


def compare_rays(bvh, vertices, faces, given, random):
    origins, directions = diffuse_rays(bvh, given.rays, random)
    in_c = InC(given.c, vertices, faces)
    hits = np.zeros((len(origins), 5), np.uint32)  # memory that has been written to: a program in C++ has it at hand
    out = bvh.intersect(origins, directions, threads=given.threads)
    times, answers = best(
        given.rounds,
        python=lambda: bvh.intersect(origins, directions, threads=given.threads),
        into=lambda: bvh.intersect(origins, directions, threads=given.threads, out=out),
        spans=lambda: in_c.intersect(origins, directions, hits, given.threads),
        fresh=lambda: in_c.intersect(origins, directions, np.empty((len(origins), 5), np.uint32), given.threads),
    )
    same = np.array_equal(answers["python"].t, hits[:, 0].view(np.float32))
    same = same and np.array_equal(answers["python"].primitive, hits[:, 3])
    rate = {name: len(origins) / seconds / 1e6 for name, seconds in times.items()}
    print(f"intersect, {len(origins)} diffuse rays, Mrays/s: Python {rate['python']:.3f}, with out= {rate['into']:.3f}; "
          f"spans {rate['spans']:.3f}, into new memory {rate['fresh']:.3f}{'' if same else '; OTHER HITS'}")
    print(f"  time of Python over that of spans: {times['python'] / times['fresh']:.3f} into new memory, "
          f"{times['into'] / times['spans']:.3f} into memory that is there; {times['python'] / times['spans']:.3f} mixed")


def compare_points(bvh, vertices, faces, given, random):
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    margin = 0.1 * (upper - lower)
    points = random.uniform(lower - margin, upper + margin, (given.queries, 3)).astype(np.float32)
    calls = {"kerf": lambda: bvh.closest_point(points, threads=given.threads)}
    inside = {"kerf": lambda: bvh.contains(points, threads=given.threads)}
    try:
        import open3d

        scene = open3d.t.geometry.RaycastingScene(nthreads=given.threads)
        scene.add_triangles(open3d.core.Tensor(vertices), open3d.core.Tensor(faces))
        tensor = open3d.core.Tensor(points)
        calls["open3d"] = lambda: scene.compute_closest_points(tensor, nthreads=given.threads)
        inside["open3d"] = lambda: scene.compute_occupancy(tensor, nthreads=given.threads)
    except ImportError:
        print("Open3D is not installed")
    times, answers = best(given.rounds, **calls)
    for name, seconds in times.items():
        print(f"closest points of {len(points)}, {name}: {seconds:.3f} s, {seconds / times['kerf']:.2f} of kerf's time")
    if "open3d" in answers:
        found = answers["open3d"]["points"].numpy()
        distances = np.linalg.norm(found - points, axis=1)
        print(f"  largest difference of distances: {np.abs(distances - answers['kerf'].distance).max():.2e}")
    try:
        import trimesh

        mesh = trimesh.Trimesh(vertices, faces, process=False)
        few = points[: max(len(points) // 100, 1)]
        trimesh.proximity.closest_point(mesh, few[:10])  # makes the tree
        begin = time.perf_counter()
        trimesh.proximity.closest_point(mesh, few)
        a_point = (time.perf_counter() - begin) / len(few)
        print(f"closest points of {len(few)}, trimesh: {a_point * len(points):.1f} s for as many, "
              f"{a_point * len(points) / times['kerf']:.0f} of kerf's time")
        closed = mesh.is_watertight
    except ImportError:
        print("trimesh is not installed")
        closed = True
    if not closed:
        print("contains: the mesh is not closed")
        return
    times, answers = best(given.rounds, **inside)
    for name, seconds in times.items():
        print(f"contains of {len(points)}, {name}: {seconds:.3f} s, {seconds / times['kerf']:.2f} of kerf's time")
    if "open3d" in answers:
        print(f"  answers that differ: {np.count_nonzero((answers['open3d'].numpy() != 0) != answers['kerf'])}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("--c", help="the shared library of the C interface")
    parser.add_argument("--rays", type=int, default=10_000_000)
    parser.add_argument("--queries", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    vertices, faces = read_obj(given.mesh)
    random = np.random.default_rng(1)
    bvh = kerf_bvh.Bvh(vertices, faces)
    if given.rays and given.c:
        compare_rays(bvh, vertices, faces, given, random)
    if given.queries:
        compare_points(bvh, vertices, faces, given, random)


if __name__ == "__main__":
    main()
