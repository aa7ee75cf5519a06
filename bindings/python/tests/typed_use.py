"""Not run: mypy reads it in its strict mode, as it reads a user's program."""

import numpy as np
import numpy.typing as npt

import kerf_bvh
import kerf_bvh.cuda


def first_hits(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.int64]) -> npt.NDArray[np.float32]:
    bvh = kerf_bvh.Bvh(vertices, faces, builder="sbvh", threads=2, progress=lambda fraction: fraction < 0.5)
    hits: kerf_bvh.Hits = bvh.intersect(vertices + [0, 0, 1], [0, 0, -1], 0.0, 10.0, mask=3)
    lists: kerf_bvh.Lists[kerf_bvh.Hits] = bvh.all_hits(vertices, [0, 0, 1])
    return np.concatenate([hits[hits.hit].t, lists[0].t])


def distances(path: str, points: list[list[float]]) -> float:
    bvh = kerf_bvh.Bvh.map(path)
    inside: npt.NDArray[np.bool_] = bvh.contains(points)
    side: kerf_bvh.Side = kerf_bvh.Side(bvh.side(points)[0])
    near: kerf_bvh.SurfacePoints = bvh.nearest(points, 3)[0]
    return float(near.distance[0]) * int(inside.sum()) * side


def seen_through(bvh: kerf_bvh.Bvh, vertices: npt.NDArray[np.float32], faces: npt.NDArray[np.int64]) -> list[int]:
    report: kerf_bvh.RefitReport = bvh.refit(vertices, faces, threads=1)
    if report.cost_ratio > 1.2 or report.rebuilt:
        bvh = kerf_bvh.Bvh(vertices, faces)
    row = kerf_bvh.Scene(bvh, np.tile(np.eye(4), (3, 1, 1)), numbers=[1, 2, 3])
    scene = kerf_bvh.Scene([row, bvh], which=[0, 1, 1], masks=1)
    hits: kerf_bvh.SceneHits = scene.intersect(vertices, [0, 0, 1], mask=1)
    near: kerf_bvh.ScenePoints = scene.within(vertices, 0.5)[0]
    lists: kerf_bvh.Lists[kerf_bvh.SceneHits] = scene.all_hits(vertices, [0, 0, 1])
    return [*scene.path(int(hits.instance[0])), int(near.instance[0]), len(lists.items)]


def on_a_device(bvh: kerf_bvh.Bvh, rays: kerf_bvh.cuda.Array, stream: kerf_bvh.cuda.Stream) -> float:
    copy = kerf_bvh.cuda.Bvh(bvh, device=0)
    built = kerf_bvh.cuda.Bvh.build(rays, rays, max_reference_ratio=2.0, stream=stream)
    hits: kerf_bvh.cuda.Hits = copy.intersect(rays, stream=stream)
    lists: kerf_bvh.Lists[kerf_bvh.Hits] = built.all_hits(rays, [0, 0, 1]).get()
    t: kerf_bvh.cuda.DeviceArray = hits.t
    return float(t.get()[0]) + float(lists[0].t[0]) + built.statistics.cost
