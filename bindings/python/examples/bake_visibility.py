"""Bakes how much of the sky points above a terrain see, on a local cluster of processes that share one hierarchy.

usage: python bake_visibility.py [POINTS] [--processes N] [--rays N]      (10,000,000 points if none are named)
"""

import argparse
import os
import tempfile

import dask.array as da
import numpy as np
from distributed import Client, LocalCluster, progress

import kerf_bvh
import kerf_bvh.dask


def terrain(n=256):
    """Hills over the unit square: vertices and faces of an n by n grid, and the height at places of it."""

    def height(x, y):
        return 0.1 * np.sin(9 * x) * np.cos(7 * y) + 0.04 * np.sin(31 * x + 2) * np.sin(27 * y)

    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1)
    faces = np.concatenate([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)])
    return np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3).astype(np.float32), faces, height


def sky(points, mapped, rays):
    """The fraction of `rays` directions, evenly over the upper half sphere, in which each point sees the sky."""
    golden = np.pi * (3 - 5**0.5)
    z = (np.arange(rays) + 0.5) / rays
    around = golden * np.arange(rays)
    radius = np.sqrt(1 - z * z)
    seen = 0
    for direction in np.stack([radius * np.cos(around), radius * np.sin(around), z], axis=1):
        along = da.broadcast_to(da.from_array(direction.astype(np.float32)), points.shape, chunks=points.chunks)
        seen = seen + ~mapped.occluded(points, along)
    return seen / rays


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("points", type=int, nargs="?", default=10_000_000)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--rays", type=int, default=16)
    arguments = parser.parse_args()

    vertices, faces, height = terrain()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "terrain.kerf")
        kerf_bvh.Bvh(vertices, faces).save(path)
        with LocalCluster(n_workers=arguments.processes, threads_per_worker=1, dashboard_address=None) as cluster:
            with Client(cluster):
                mapped = kerf_bvh.dask.MappedBvh(path)
                random = da.random.default_rng(1)
                place = random.random((arguments.points, 2), chunks=(250_000, 2), dtype=np.float32)
                above = height(place[:, 0], place[:, 1]) + 0.02
                points = da.concatenate([place, above[:, None]], axis=1).rechunk((250_000, 3)).astype(np.float32)
                visibility = sky(points, mapped, arguments.rays).mean().persist()
                progress(visibility)
                print(f"\nof the sky, {arguments.points} points see {100 * float(visibility.compute()):.1f} %")


if __name__ == "__main__":
    main()
