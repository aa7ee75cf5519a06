"""Open3D's RaycastingScene: its names, shapes, types and conventions."""

import numpy as np
import pytest
import support

from kerf_bvh.open3d import RaycastingScene


@pytest.fixture
def scene():
    scene = RaycastingScene()
    assert scene.add_triangles(support.CUBE_VERTICES, support.CUBE_FACES) == 0
    moved = support.OnlyDlpack(support.CUBE_VERTICES + np.float32(5))
    assert scene.add_triangles(moved, support.OnlyDlpack(support.CUBE_FACES)) == 1
    return scene


RAYS = np.array([[[0.25, 0.5, 3, 0, 0, -2], [9, 9, 9, 1, 0, 0]]], np.float32)


def told(answers):
    return {name: (array.dtype.name, array.shape) for name, array in answers.items()}


def test_casts_have_the_fields_shapes_and_types_of_open3d(scene):
    answers = scene.cast_rays(support.OnlyDlpack(RAYS))
    assert told(answers) == {
        "t_hit": ("float32", (1, 2)),
        "geometry_ids": ("uint32", (1, 2)),
        "primitive_ids": ("uint32", (1, 2)),
        "primitive_uvs": ("float32", (1, 2, 2)),
        "primitive_normals": ("float32", (1, 2, 3)),
    }
    assert answers["t_hit"].tolist() == [[1, np.inf]]
    assert answers["geometry_ids"].tolist() == [[0, RaycastingScene.INVALID_ID]]
    assert answers["primitive_uvs"][0, 0].tolist() == [0.25, 0.25]
    assert answers["primitive_normals"].tolist() == [[[0, 0, 1], [0, 0, 0]]]


def test_counts_and_lists_agree(scene):
    counts, lists = scene.count_intersections(RAYS), scene.list_intersections(RAYS)
    assert counts.dtype == np.int32 and counts.tolist() == [[2, 0]]
    assert lists["ray_splits"].tolist() == [0, 2, 2] and lists["ray_ids"].tolist() == [0, 0]
    assert lists["t_hit"].tolist() == [1, 1.5] and lists["primitive_ids"].tolist() == [3, 1]
    assert lists["primitive_uvs"].shape == (2, 2)


def test_occlusions_keep_to_their_limits(scene):
    assert scene.test_occlusions(RAYS).tolist() == [[True, False]]
    assert scene.test_occlusions(RAYS, tfar=0.9).tolist() == [[False, False]]
    assert scene.test_occlusions(RAYS, 1.2, 1.4).tolist() == [[False, False]]


def test_points_are_answered(scene):
    points = np.array([[0.25, 0.5, 3], [0.5, 0.5, 0.5], [9, 9, 9]], np.float32)
    closest = scene.compute_closest_points(points)
    assert closest["points"].tolist()[0] == [0.25, 0.5, 1] and closest["geometry_ids"].tolist() == [0, 0, 1]
    assert closest["points"].tolist()[2] == [6, 6, 6]
    assert scene.compute_distance(points) == pytest.approx([2, 0.5, 27**0.5])
    assert scene.compute_signed_distance(points, nsamples=3) == pytest.approx([2, -0.5, 27**0.5])
    occupancy = scene.compute_occupancy(points)
    assert occupancy.dtype == np.float32 and occupancy.tolist() == [0, 1, 0]


def test_cameras_look_where_they_are_told():
    rays = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], [0, 0, 5], [0, 1, 0], 4, 3)
    assert rays.shape == (3, 4, 6) and rays.dtype == np.float32
    assert rays[0, 0] == pytest.approx([0, 0, 5, 0.4330127, -0.2886751, -1], abs=1e-6)
    moved = np.eye(4)
    moved[:3, 3] = [1, 2, 3]
    camera = [[100, 0, 2], [0, 100, 1.5], [0, 0, 1]]
    rays = RaycastingScene.create_rays_pinhole(
        intrinsic_matrix=camera, extrinsic_matrix=moved, width_px=4, height_px=3
    )
    assert rays[0, 0] == pytest.approx([-1, -2, -3, -0.015, -0.01, 1], abs=1e-6)
    with pytest.raises(TypeError, match="create_rays_pinhole"):
        RaycastingScene.create_rays_pinhole(60, [0, 0, 0])


def test_a_scene_may_grow_and_an_empty_one_answers(scene):
    assert scene.test_occlusions(RAYS).any()
    scene.add_triangles(support.CUBE_VERTICES + np.float32(2), support.CUBE_FACES)
    assert scene.cast_rays([2.5, 2.25, 9, 0, 0, -1])["geometry_ids"] == 2
    empty = RaycastingScene()
    assert np.isinf(empty.cast_rays(RAYS)["t_hit"]).all() and np.isinf(empty.compute_distance([[0, 0, 0]])).all()


def test_meshes_with_both_arrays_are_taken_and_others_refused():
    class Mesh:
        vertex = {"positions": support.CUBE_VERTICES}
        triangle = {"indices": support.CUBE_FACES}

    class Legacy:
        vertices, triangles = support.CUBE_VERTICES.astype(float), support.CUBE_FACES.astype(np.int32)

    for mesh in (Mesh(), Legacy()):
        scene = RaycastingScene()
        scene.add_triangles(mesh)
        assert scene.compute_occupancy([0.5, 0.5, 0.5]) == 1
    with pytest.raises(TypeError, match="is no mesh"):
        RaycastingScene().add_triangles(support.CUBE_VERTICES)
    with pytest.raises(ValueError, match=r"^rays: shape \(3,\), where \(..., 6\) is needed"):
        RaycastingScene().cast_rays([0, 0, 0])
