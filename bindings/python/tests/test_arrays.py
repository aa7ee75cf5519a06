"""Whatever holds numbers is taken for what it is, or refused in one sentence."""

import array as standard_array
import re

import numpy as np
import pytest
import support

import kerf_bvh

ORIGINS = np.array([[0.25, 0.5, 2], [0.5, 0.25, 3], [5, 5, 5]], np.float32)
DOWN = np.array([0, 0, -1], np.float32)
T = [1, 2, np.inf]


def forms():
    """The same origins in other clothes."""
    packed = np.zeros(3, np.dtype([("flag", "u1"), ("place", "f4", (3,))]))
    packed["place"] = ORIGINS
    read_only = ORIGINS.copy()
    read_only.flags.writeable = False
    return {
        "contiguous": ORIGINS,
        "column-major": np.asfortranarray(ORIGINS),
        "every other row": np.repeat(ORIGINS, 2, axis=0)[::2],
        "every other column": np.repeat(ORIGINS, 2, axis=1)[:, ::2],
        "backwards": ORIGINS[::-1].copy()[::-1],
        "columns backwards": ORIGINS[:, ::-1].copy()[:, ::-1],
        "not aligned": packed["place"],
        "read-only": read_only,
        "big-endian": ORIGINS.astype(">f4"),
        "float64": ORIGINS.astype(np.float64),
        "float16": ORIGINS.astype(np.float16),
        "longdouble": ORIGINS.astype(np.longdouble),
        "a list": ORIGINS.tolist(),
        "a matrix": np.asmatrix(ORIGINS),
        "masked, nothing masked": np.ma.array(ORIGINS),
        "through DLPack": support.OnlyDlpack(ORIGINS),
        "a buffer": memoryview(standard_array.array("f", ORIGINS.reshape(-1))).cast("B").cast("f", (3, 3)),
    }


class OnAnotherDevice(support.OnlyDlpack):
    def __dlpack__(self, **arguments):
        raise BufferError("it lies on cuda:0")

    def __dlpack_device__(self):
        return 2, 0


@pytest.mark.parametrize("form", forms().keys())
def test_rays_points_and_vertices_of_every_form_give_the_same_answers(cube, form):
    value = forms()[form]
    assert cube.intersect(value, DOWN).t.tolist() == T
    assert cube.intersect(value, DOWN, 0, np.float32(1.5)).hit.tolist() == [True, False, False]
    assert cube.signed_distance(value)[0] == 1
    triangle = kerf_bvh.Bvh(value, [[0, 1, 2]])
    assert triangle.triangles(0).tolist() == ORIGINS.tolist()


@pytest.mark.parametrize("dtype", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", ">i4", ">u8"])
@pytest.mark.parametrize("precision", ["f4", "f8"])
def test_faces_of_every_integer_type_are_read(dtype, precision):
    bvh = kerf_bvh.Bvh(support.CUBE_VERTICES.astype(precision), support.CUBE_FACES.astype(dtype))
    assert bvh.statistics.triangles == 12
    assert bvh.intersect([0.25, 0.5, 2], DOWN).primitive == 3


def test_faces_of_any_strides_are_read():
    wide = np.zeros((12, 5), np.int64)
    wide[:, 1:4] = support.CUBE_FACES
    for faces in (wide[:, 1:4], np.asfortranarray(support.CUBE_FACES), support.CUBE_FACES[::-1].copy()[::-1]):
        assert kerf_bvh.Bvh(support.CUBE_VERTICES, faces).contains([0.5, 0.5, 0.5])


def test_answers_have_the_shape_of_the_questions(cube):
    origins = np.zeros((4, 5, 3)) + [0.5, 0.25, 2]
    hits = cube.intersect(origins, DOWN)
    assert hits.t.shape == hits.primitive.shape == hits.hit.shape == (4, 5)
    assert cube.intersect(origins[0, 0], np.tile(DOWN, (7, 1))).t.shape == (7,)
    assert cube.intersect(origins[0, 0], DOWN).t.shape == ()
    assert cube.occluded(origins, DOWN).shape == (4, 5)
    assert cube.contains(origins).shape == (4, 5)
    assert cube.closest_point(origins).position.shape == (4, 5, 3)
    assert cube.closest_point(origins)[0, 1:3].distance.tolist() == [1, 1]
    assert len(cube.all_hits(origins, DOWN)) == 20


def test_nothing_asked_is_nothing_answered(cube):
    for nothing in ([], np.empty((0, 3)), np.empty((0, 3), np.float32), np.empty((3, 0, 3))):
        assert cube.intersect(nothing, DOWN).t.size == 0
        assert cube.occluded(nothing, DOWN).size == 0
        assert cube.contains(nothing).size == 0
        assert cube.closest_point(nothing).distance.size == 0
        assert len(cube.all_hits(nothing, DOWN)) == 0
        assert len(cube.within(nothing, 1)) == 0
    assert len(cube.triangles_in([])) == 0


def test_a_hierarchy_of_nothing_answers():
    for nothing in (kerf_bvh.Bvh(), kerf_bvh.Bvh(np.empty((0, 3)), np.empty((0, 3), int)), kerf_bvh.Bvh([], [])):
        assert not nothing.intersect(ORIGINS, DOWN).hit.any()
        assert np.isinf(nothing.signed_distance(ORIGINS)).all()
        assert len(nothing.all_hits(ORIGINS, DOWN).items) == 0
        assert nothing.bounds is None


def refused(kind, what):
    return pytest.raises(kind, match=f"^{re.escape(what)}")


def test_what_is_no_array_of_triples_is_refused(cube):
    with refused(ValueError, "points: shape (3, 2), where (..., 3) is needed"):
        cube.contains(np.zeros((3, 2)))
    with refused(ValueError, "points: shape (), where (..., 3) is needed"):
        cube.contains(1.0)
    with refused(ValueError, "origins and directions: shapes (2, 3) and (3, 3), which do not fit each other"):
        cube.intersect(np.zeros((2, 3)), np.zeros((3, 3)))
    with refused(TypeError, "points: elements of type complex128, where real numbers are needed"):
        cube.contains(np.zeros((3, 3), complex))
    with refused(TypeError, "points: elements of type <U1, where real numbers are needed"):
        cube.contains([["a", "b", "c"]])
    with refused(ValueError, "points: not an array"):
        cube.contains([[1, 2, 3], [1, 2]])
    with refused(ValueError, "points: 1 elements are masked; fill them in or leave them out"):
        cube.contains(np.ma.array([[1.0, 2, 3]], mask=[[True, False, False]]))
    with refused(ValueError, "points: its memory cannot be read from here (it lies on cuda:0)"):
        cube.contains(OnAnotherDevice(ORIGINS))


def test_limits_and_masks_that_do_not_fit_are_refused(cube):
    with refused(ValueError, "t_max: shape (2,), where one number or (3,) is needed"):
        cube.intersect(ORIGINS, DOWN, 0, [1, 2])
    with refused(ValueError, "mask: numbers beyond 32 bits"):
        cube.intersect(ORIGINS, DOWN, mask=-1)
    with refused(TypeError, "mask: elements of type float64, where integers are needed"):
        cube.intersect(ORIGINS, DOWN, mask=1.0)
    with refused(TypeError, "accept: elements of type int64, where bool is needed"):
        cube.intersect(ORIGINS, DOWN, accept=np.ones(12, np.int64))
    with refused(ValueError, "accept: shape (11,) for the 12 triangles of mesh 0"):
        cube.intersect(ORIGINS, DOWN, accept=np.ones(11, bool))
    with refused(ValueError, "threads: -1, where a number from 0 is needed, 0 for all"):
        cube.intersect(ORIGINS, DOWN, threads=-1)


def test_triangles_that_name_no_vertex_are_refused():
    for precision in ("f4", "f8"):
        for dtype in ("i4", "u4", "i8", "u8"):
            with pytest.raises(ValueError, match="triangle 0.* names vertex 8, but there are only 8"):
                kerf_bvh.Bvh(support.CUBE_VERTICES.astype(precision), np.array([[0, 1, 8]], dtype))
        with refused(ValueError, "faces: triangle 1 names vertex -1, but numbers begin at 0"):
            kerf_bvh.Bvh(support.CUBE_VERTICES.astype(precision), [[0, 1, 2], [0, -1, 2]])
        with pytest.raises(ValueError, match="triangle 0.* names vertex 4294967297, but there are only 8"):
            kerf_bvh.Bvh(support.CUBE_VERTICES.astype(precision), [[0, 1, 2**32 + 1]])
    with refused(ValueError, "faces: none, which needs vertices of shape (t, 3, 3)"):
        kerf_bvh.Bvh(support.CUBE_VERTICES)
    with refused(TypeError, "faces: elements of type float64, where integers are needed"):
        kerf_bvh.Bvh(support.CUBE_VERTICES, [[0.0, 1, 2]])
    with refused(ValueError, "faces: shape (1, 4), where (t, 3) is needed"):
        kerf_bvh.Bvh(support.CUBE_VERTICES, [[0, 1, 2, 3]])


def test_float32_vertices_are_not_copied_and_may_change_afterwards():
    vertices = support.CUBE_VERTICES.copy()
    bvh = kerf_bvh.Bvh(vertices, support.CUBE_FACES)
    vertices[:] = np.nan
    assert bvh.contains([0.5, 0.5, 0.5])


def test_what_is_given_is_not_written_to(cube):
    before = ORIGINS.copy()
    cube.intersect(ORIGINS, DOWN)
    cube.closest_point(ORIGINS)
    assert np.array_equal(before, ORIGINS)


def test_more_than_memory_can_answer_is_refused_at_once(cube):
    huge = np.broadcast_to(np.float32(0), (2**40, 3))
    for ask in (cube.contains, cube.closest_point, lambda points: cube.intersect(points, DOWN)):
        with pytest.raises(MemoryError):
            ask(huge)
    with refused(MemoryError, "not enough memory for the lists of 1099511627776 questions"):
        cube.all_hits(huge, DOWN)
