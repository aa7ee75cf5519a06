"""kerf: exact, watertight ray tracing and spatial queries on triangle meshes.

    bvh = kerf_bvh.Bvh(vertices, faces)
    hits = bvh.intersect(origins, directions)
"""

from ._bvh import BuildOptions, Bvh, build_memory_bound, measure
from ._kerf import Cancelled
from ._questions import ALL
from ._results import (
    INVALID,
    Geometry,
    Hits,
    Lists,
    Measures,
    MeshStatistics,
    Primitives,
    RefitReport,
    SceneHits,
    ScenePoints,
    ScenePrimitives,
    SceneTouchingPairs,
    Side,
    Statistics,
    SurfacePoints,
    TouchingPairs,
)
from ._scene import Scene

__version__ = "0.1.0"

__all__ = [
    "ALL",
    "INVALID",
    "BuildOptions",
    "Bvh",
    "Cancelled",
    "Geometry",
    "Hits",
    "Lists",
    "Measures",
    "MeshStatistics",
    "Primitives",
    "RefitReport",
    "Scene",
    "SceneHits",
    "ScenePoints",
    "ScenePrimitives",
    "SceneTouchingPairs",
    "Side",
    "Statistics",
    "SurfacePoints",
    "TouchingPairs",
    "build_memory_bound",
    "measure",
]
