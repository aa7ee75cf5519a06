"""Ambient occlusion, baked to the vertices of a terrain: which part of the sky each of them sees.

usage: python ambient_occlusion.py FILE.png
"""

import sys

import numpy as np
from picture import sphere_of_directions, terrain, write_png

import kerf_bvh

n = 200
vertices, faces = terrain(n)
bvh = kerf_bvh.Bvh(vertices, faces)

directions = sphere_of_directions(256)
directions = directions[directions[:, 2] > 0]  # the sky
seen = np.zeros(len(vertices))
for direction in directions:  # all vertices at once, one direction after the other
    seen += ~bvh.occluded(vertices, direction, t_min=1e-4)

write_png(sys.argv[1], (seen / len(directions)).reshape(n, n) ** 3)
print(f"vertices see from {100 * seen.min() / len(directions):.0f} % of the sky")
