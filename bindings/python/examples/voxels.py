"""Inside and outside as voxels: a torus, cut through its middle; the distance to its surface shades them.

usage: python voxels.py FILE.png
"""

import sys

import numpy as np
from picture import torus, write_png

import kerf_bvh

bvh = kerf_bvh.Bvh(*torus())
n = 64
centres = (np.arange(n) + 0.5) / n * 3 - 1.5
points = np.stack(np.meshgrid(centres, centres, centres, indexing="ij"), axis=-1)

inside = bvh.contains(points)  # (64, 64, 64)
distance = bvh.signed_distance(points[:, :, n // 2])
shade = np.where(inside[:, :, n // 2], 0.6 - distance, 0.35 * np.exp(-3 * np.abs(distance)))
write_png(sys.argv[1], np.kron(shade, np.ones((6, 6))))
print(f"{inside.sum()} of {inside.size} voxels are inside, {3**3 * inside.mean():.2f} units of volume")
