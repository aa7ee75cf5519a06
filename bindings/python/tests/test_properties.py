"""Properties: whatever meshes, rays, points and arrays look like, answers are those of rationals."""

from fractions import Fraction

import numpy as np
import support
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import kerf_bvh

# The same examples at each run.
quickly = settings(deadline=None, max_examples=40, derandomize=True)

# A coarse grid, on which rays meet edges, vertices and planes, and numbers of any size between.
coordinates = st.one_of(
    st.integers(-3, 3).map(float), st.floats(-4, 4, width=32).filter(lambda x: x == 0 or abs(x) > 1e-6)
)
points = hnp.arrays(np.float32, st.tuples(st.integers(1, 6), st.just(3)), elements=coordinates)


def with_area(corners):
    return [support.exact(triangle) for triangle in corners]


triangle_lists = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 12), st.just(3), st.just(3)), elements=coordinates
).map(
    lambda corners: corners[
        [any(support.cross(support.subtract(b, a), support.subtract(c, a))) for a, b, c in with_area(corners)]
    ]
)


@quickly
@given(triangle_lists, points, points)
def test_the_first_hit_is_the_smallest_t_of_rationals(corners, origins, directions):
    count = min(len(origins), len(directions))
    origins, directions = origins[:count], directions[:count]
    directions[(directions == 0).all(axis=1)] = [0, 0, 1]
    bvh = kerf_bvh.Bvh(corners)
    hits = bvh.intersect(origins, directions)
    exact = [support.exact(triangle) for triangle in corners]
    for i, (origin, direction) in enumerate(zip(support.exact(origins), support.exact(directions))):
        crossings = [support.crossing(origin, direction, triangle) for triangle in exact]
        ahead = [t for t in crossings if t is not None and t >= 0]
        assert hits.hit[i] == bool(ahead)
        if ahead:
            first = min(ahead)
            assert abs(Fraction(float(hits.t[i])) - first) <= first / 2**23 + Fraction(1, 2**149)
            assert crossings[hits.primitive[i]] is not None


@quickly
@given(triangle_lists, points)
def test_closest_points_are_as_near_as_those_of_rationals(corners, queries):
    bvh = kerf_bvh.Bvh(corners)
    closest = bvh.closest_point(queries)
    for i, point in enumerate(support.exact(queries)):
        squared = min((support.squared_distance(point, support.exact(t)) for t in corners), default=None)
        assert closest.found[i] == (squared is not None)
        if squared is not None:
            assert abs(float(closest.distance[i]) - float(squared) ** 0.5) <= 1e-5


@quickly
@given(points, points)
def test_a_line_crosses_a_closed_surface_an_even_number_of_times(origins, directions):
    count = min(len(origins), len(directions))
    origins, directions = origins[:count], directions[:count]
    directions[(directions == 0).all(axis=1)] = [0, 0, 1]
    cube = kerf_bvh.Bvh(support.CUBE_VERTICES, support.CUBE_FACES)
    ahead, behind = cube.count_hits(origins, directions), cube.count_hits(origins, -directions)
    on = cube.side(origins) == kerf_bvh.Side.ON
    assert ((ahead + behind) % 2 == 0)[~on].all()
    inside = ((origins > 0) & (origins < 1)).all(axis=1)
    assert (cube.contains(origins)[~on] == inside[~on]).all()
    assert (on == (((origins >= 0) & (origins <= 1)).all(axis=1) & ~inside)).all()


@quickly
@given(
    st.data(),
    hnp.arrays(np.float64, st.tuples(st.integers(0, 5), st.integers(0, 5), st.just(3)), elements=coordinates),
)
def test_strides_and_types_do_not_change_answers(data, queries):
    bvh = kerf_bvh.Bvh(*support.sphere(6, 8))
    expected = bvh.signed_distance(queries.astype(np.float32))
    wide = np.zeros((*queries.shape[:2], 9), data.draw(st.sampled_from(["f4", "f8", ">f4", ">f8", "g"])))
    step = data.draw(st.sampled_from([1, 2, 3, -1, -2]))
    start = data.draw(st.integers(0, 2)) if step > 0 else data.draw(st.integers(6, 8))
    view = wide[..., start :: step][..., :3]
    view[...] = queries
    if data.draw(st.booleans()):
        view = view.swapaxes(0, 1)
        expected = expected.T
    assert np.array_equal(bvh.signed_distance(view), expected)
    assert np.array_equal(bvh.intersect(view, [0, 0, 1]).t, bvh.intersect(view.copy(), [[0, 0, 1]]).t)
