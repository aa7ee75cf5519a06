"""A lidar scan as points: rays from a sensor that turns above a terrain, seen from above, brighter where nearer.

usage: python lidar_scan.py FILE.png
"""

import sys

import numpy as np
from picture import terrain, write_png

import kerf_bvh

bvh = kerf_bvh.Bvh(*terrain())
sensor = np.array([0.5, 0.5, 0.25], np.float32)
turn, tilt = np.meshgrid(np.linspace(0, 2 * np.pi, 2000, endpoint=False), np.radians(np.linspace(-80, -12, 64)))
directions = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1)

hits = bvh.intersect(sensor, directions)
points = sensor + hits.t[hits.hit][:, None] * directions[hits.hit]

picture = np.zeros((400, 400))
row, column = (np.clip(points[:, :2], 0, 0.9999) * 400).astype(int).T
np.maximum.at(picture, (row, column), 1 - 0.8 * hits.t[hits.hit] / hits.t[hits.hit].max())
write_png(sys.argv[1], picture)
print(f"{len(points)} points of {hits.t.size} rays")
