"""Lines of sight: which places of a terrain a watchtower overlooks.

usage: python line_of_sight.py FILE.png
"""

import sys

import numpy as np
from picture import terrain, write_png

import kerf_bvh

n = 200
vertices, faces = terrain(n)
bvh = kerf_bvh.Bvh(vertices, faces)

ground = bvh.intersect([0.3, 0.62, 1], [0, 0, -1])
tower = np.array([0.3, 0.62, 1 - ground.t + 0.06])
eyes = vertices + [0, 0, 0.004]
is_seen = ~bvh.occluded(eyes, tower - eyes, t_max=1.0)  # t counts in lengths of the direction: 1 is the tower

height = vertices[:, 2] - vertices[:, 2].min()
write_png(sys.argv[1], (np.where(is_seen, 0.55, 0.1) + 0.4 * height / height.max()).reshape(n, n))
print(f"the tower overlooks {100 * is_seen.mean():.0f} % of the places")
