"""Wall thickness: how far it is through a torus behind each place that a camera sees.

usage: python thickness.py FILE.png
"""

import sys

import numpy as np
from picture import torus, write_png

import kerf_bvh

bvh = kerf_bvh.Bvh(*torus(thickness=0.35, wave=0.4))
x, y = np.meshgrid(np.linspace(-1.6, 1.6, 320), np.linspace(-1.6, 1.6, 320))
tilted = np.array([0.0, 0.5, -1.0]) / np.hypot(0.5, 1)
origins = np.stack([x, y, np.zeros_like(x)], axis=-1) - 4 * tilted
directions = np.broadcast_to(tilted, origins.shape)

hits = bvh.intersect(origins, directions)
at = bvh.geometry(origins, directions, hits)
places = (origins + np.where(hits.hit, hits.t, 0)[..., None] * directions)[hits.hit]
through = bvh.intersect(places, -at.normal[hits.hit], t_min=1e-3)  # inwards, along the normal

thickness = np.zeros(hits.t.shape)
thickness[hits.hit] = through.t
write_png(sys.argv[1], thickness / thickness.max())
print(f"between {through.t.min():.2f} and {through.t.max():.2f} thick")
