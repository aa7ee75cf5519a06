"""Rays: every answer is that of brute force in rationals."""

import numpy as np
import pytest
import support

import kerf_bvh


def scene(random, count=60):
    """Triangles with corners on a coarse grid, so that rays meet edges, vertices and planes."""
    corners = random.integers(0, 5, (count, 3, 3)).astype(np.float32)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return corners[area > 0]


def rays(random, count=60):
    origins = random.integers(-1, 6, (count, 3)) + random.choice([0, 0.25], (count, 3))
    directions = random.integers(-3, 4, (count, 3))
    directions[(directions == 0).all(axis=1)] = [1, 0, 0]
    return origins.astype(np.float32), directions.astype(np.float32)


def exact_hits(triangles, origin, direction):
    """(t, number) of every triangle that the ray meets, in order."""
    [origin], [direction] = support.exact([origin]), support.exact([direction])
    hits = []
    for number, triangle in enumerate(triangles):
        t = support.crossing(origin, direction, triangle)
        if t is not None and t >= 0:
            hits.append((t, number))
    return sorted(hits)


def test_the_closest_hit_is_that_of_rationals(random):
    corners = scene(random)
    triangles = [support.exact(triangle) for triangle in corners]
    bvh = kerf_bvh.Bvh(corners)
    origins, directions = rays(random)
    hits, blocked = bvh.intersect(origins, directions), bvh.occluded(origins, directions)
    for i in range(len(origins)):
        expected = exact_hits(triangles, origins[i], directions[i])
        assert hits.hit[i] == blocked[i] == bool(expected)
        if expected:
            assert hits.t[i] == pytest.approx(float(expected[0][0]), rel=1.2e-7, abs=0)
            assert hits.t[i] == np.float32(float(dict((n, t) for t, n in expected)[hits.primitive[i]]))


def test_all_hits_are_counted_and_listed_in_order(ball, random):
    origins = random.normal(size=(200, 3)) * 2
    directions = random.normal(size=(200, 3))
    lists, counts = ball.all_hits(origins, directions), ball.count_hits(origins, directions)
    assert lists.counts.tolist() == counts.tolist()
    assert len(lists) == 200 and lists.offsets[-1] == len(lists.items)
    inside = ball.contains(origins)
    assert (counts % 2 == inside).all()
    first = ball.intersect(origins, directions)
    for i in range(200):
        hits = lists[i]
        assert (np.diff(hits.t) >= 0).all() and len(set(hits.primitive.tolist())) == len(hits)
        if len(hits):
            assert hits.t[0] == first.t[i]
    assert lists.question.tolist() == [i for i in range(200) for _ in range(counts[i])]
    assert lists[-1].t.tolist() == lists[199].t.tolist()
    with pytest.raises(IndexError):
        lists[200]


def test_limits_are_included(cube):
    down = ([0.25, 0.5, 3], [0, 0, -1])
    assert cube.intersect(*down).t == 2
    assert cube.occluded(*down, 0, 2) and not cube.occluded(*down, 0, np.nextafter(np.float32(2), np.float32(0)))
    assert cube.intersect(*down, 2.5).t == 3
    assert cube.intersect([0.25, 0.5, 0.5], [0, 0, -1], -np.inf).t == -0.5
    assert cube.intersect(np.tile(down[0], (2, 1)), down[1], [0, 2.5], [9, 9]).t.tolist() == [2, 3]
    assert cube.count_hits(*down, 2, 3) == 2 and cube.count_hits(*down, 2.5, 3) == 1


def test_triangles_that_are_not_accepted_let_rays_pass(cube):
    accept = np.ones(12, bool)
    accept[[2, 3]] = False  # the top
    down = ([0.25, 0.5, 3], [0, 0, -1])
    assert cube.intersect(*down, accept=accept).t == 3
    assert cube.intersect(*down, accept=[accept]).t == 3
    assert not cube.occluded(*down, 0, 2.5, accept=accept)


def test_hits_are_written_where_the_caller_says(cube):
    out = kerf_bvh.Hits.empty(2)
    assert cube.intersect([[0.25, 0.5, 3]] * 2, [0, 0, -1], out=out) is out
    assert out.t.tolist() == [2, 2]
    for wrong in (kerf_bvh.Hits.empty(3), kerf_bvh.Hits(*(column[::2] for column in vars(kerf_bvh.Hits.empty(4)).values()))):
        with pytest.raises(ValueError, match="^out: t has to be writeable, contiguous, float32, and of shape"):
            cube.intersect([[0.25, 0.5, 3]] * 2, [0, 0, -1], out=wrong)


def test_geometry_tells_corners_normal_and_side(cube):
    origins, directions = [[0.25, 0.5, 3], [0.25, 0.5, 0.5], [9, 9, 9]], [0, 0, -1]
    at = cube.geometry(origins, directions, cube.intersect(origins, directions))
    assert at.normal[:2].tolist() == [[0, 0, 1], [0, 0, -1]] and np.isnan(at.normal[2]).all()
    assert at.front.tolist() == [True, False, False]
    assert at.corners[0].tolist() == support.CUBE_VERTICES[support.CUBE_FACES[3]].tolist()


def test_surveyed_coordinates_answer_as_near_the_origin(random):
    vertices, faces = support.sphere()
    vertices = np.round(vertices, 6)
    place = np.array([431_200.0, 5_412_800.0, 320.0])
    near, far = kerf_bvh.Bvh(vertices.astype(np.float32), faces), kerf_bvh.Bvh(vertices + place, faces)
    assert far.origin.any() and np.abs(far.origin - place).max() <= 1
    origins, directions = random.normal(size=(500, 3)) * 2, random.normal(size=(500, 3))
    here, there = near.intersect(origins, directions), far.intersect(origins + place, directions)
    same = here.primitive == there.primitive
    assert same.mean() > 0.99 and np.allclose(here.t[same], there.t[same], atol=2e-5)
    assert np.allclose(near.signed_distance(origins), far.signed_distance(origins + place), atol=1e-6)
    closest = far.closest_point(origins + place)
    assert closest.position.dtype == np.float64
    assert np.allclose(closest.position - place, near.closest_point(origins).position, atol=1e-6)
    assert np.allclose(far.bounds - place, near.bounds, atol=1e-6)
    assert np.allclose(far.triangles([0, 1]) - place, vertices[faces[[0, 1]]], atol=1e-6)
