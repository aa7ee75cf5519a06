"""Points, boxes, and meshes against meshes."""

import numpy as np
import pytest
import support

import kerf_bvh


def test_distances_are_those_of_rationals(random):
    corners = random.integers(0, 5, (30, 3, 3)).astype(np.float32)
    corners = corners[np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 0]
    triangles = [support.exact(triangle) for triangle in corners]
    points = (random.integers(-2, 7, (40, 3)) + random.choice([0, 0.5], (40, 3))).astype(np.float32)
    bvh = kerf_bvh.Bvh(corners)
    closest, near, around = bvh.closest_point(points), bvh.nearest(points, 5), bvh.within(points, 2.0)
    for i, point in enumerate(support.exact(points)):
        squared = [support.squared_distance(point, triangle) for triangle in triangles]
        assert closest.distance[i] == pytest.approx(float(min(squared)) ** 0.5, rel=1e-6)
        assert float(squared[closest.primitive[i]]) == pytest.approx(float(min(squared)), rel=1e-12)
        assert near[i].distance == pytest.approx([float(s) ** 0.5 for s in sorted(squared)[:5]], rel=1e-6)
        assert sorted(around[i].primitive) == [n for n, s in enumerate(squared) if s <= 4]
    apart = np.linalg.norm(points.astype(float) - closest.position, axis=1)
    assert np.allclose(apart, closest.distance, atol=1e-6)


def test_inside_on_and_outside_are_told(cube):
    points = [[0.5, 0.5, 0.5], [1, 0.5, 0.5], [1, 1, 1], [1.001, 0.5, 0.5]]
    assert cube.contains(points).tolist() == [True, True, True, False]
    side = kerf_bvh.Side
    assert cube.side(points).tolist() == [side.INSIDE, side.ON, side.ON, side.OUTSIDE]
    assert cube.signed_distance([[0.5, 0.5, 0.25], [0.5, 0.5, 3]]).tolist() == [-0.25, 2]


def test_limits_of_distance_are_included(cube):
    assert cube.closest_point([0.5, 0.5, 3], 2.0).found
    nothing = cube.closest_point([0.5, 0.5, 3], 1.9)
    assert not nothing.found and np.isinf(nothing.distance) and nothing.primitive == kerf_bvh.INVALID
    assert len(cube.nearest([0.5, 0.25, 3], 100).items) == 12
    assert len(cube.nearest([0.5, 0.25, 3], 100, 2.0).items) == 1
    with pytest.raises(ValueError, match="^count: -1"):
        cube.nearest([0.5, 0.25, 3], -1)


def test_positions_have_the_type_of_the_points(cube):
    for dtype in (np.float32, np.float64):
        assert cube.closest_point(np.zeros((2, 3), dtype)).position.dtype == dtype
        assert cube.within(np.zeros((2, 3), dtype), 1).items.position.dtype == dtype


def test_triangles_that_touch_a_box_are_listed(cube):
    lists = cube.triangles_in([[[0.6, 0.2, 0.9], [0.8, 0.4, 1.1]], [[2, 2, 2], [3, 3, 3]], [[1, 1, 1], [2, 2, 2]]])
    assert lists[0].primitive.tolist() == [2] and len(lists[1]) == 0
    touching = [i for i, face in enumerate(support.CUBE_FACES) if 6 in face]
    assert lists[2].primitive.tolist() == touching
    with pytest.raises(ValueError, match=r"^boxes: shape \(3,\), where \(..., 2, 3\) is needed"):
        cube.triangles_in([0, 0, 0])


def test_pairs_that_touch_are_listed_wherever_the_frames_lie(cube):
    aside = np.eye(4)
    aside[0, 3] = 1
    assert cube.touches(cube, aside) and cube.touches(cube, aside[:3])
    aside[0, 3] = 1.001
    assert not cube.touches(cube, aside)
    half = np.hstack([np.eye(3), [[0.5], [0.5], [0.5]]])
    pairs = cube.touching_pairs(cube, half)
    assert len(pairs) == len(pairs.first) == 18
    place = np.array([500_000.1, 4_000_000.3, 7.7])
    there = kerf_bvh.Bvh(support.CUBE_VERTICES + place, support.CUBE_FACES)
    assert there.origin.any()
    back = np.hstack([np.eye(3), (0.5 - place)[:, None]])
    assert len(cube.touching_pairs(there, back)) > 0
    with pytest.raises(ValueError, match="^transform: its last row"):
        cube.touches(cube, np.ones((4, 4)))
    with pytest.raises(ValueError, match=r"^transform: shape \(3, 3\)"):
        cube.touches(cube, np.eye(3))


def test_triangles_are_found_by_their_numbers(cube):
    assert np.array_equal(cube.triangles(np.arange(12)), support.CUBE_VERTICES[support.CUBE_FACES])
    assert np.isnan(cube.triangles(12)).all() and np.isnan(cube.triangles(0, 1)).all()
    assert cube.triangles([[0, 1], [2, 3]]).shape == (2, 2, 3, 3)
