"""kerf in the place of trimesh's rays and proximity: its conventions, and the cases of its tracker."""

import copy
import pickle

import numpy as np
import pytest
import trimesh

import kerf_bvh
import kerf_bvh.trimesh


@pytest.fixture
def everywhere():
    kerf_bvh.trimesh.use()
    yield
    kerf_bvh.trimesh.restore()


def box(size=2.0):
    mesh = trimesh.creation.box(extents=[size] * 3)
    kerf_bvh.trimesh.use(mesh)
    return mesh


def test_orders_of_arguments_and_results_are_those_of_both_engines():
    mesh = box()
    origins, directions = [[0.25, 0.5, 5], [9, 9, 9], [0.5, 0.25, 5]], [[0, 0, -2.0]] * 3
    for engine in (mesh.ray, kerf_bvh.trimesh.RayTriangleIntersector(mesh)):
        locations, rays, faces = engine.intersects_location(origins, directions)
        assert rays.tolist() == [0, 0, 2, 2] and locations[:, 2].tolist() == [1, -1, 1, -1]
        assert locations.dtype == np.float64 and rays.dtype == faces.dtype == np.int64
        assert np.allclose(mesh.face_normals[faces[[0, 2]]], [0, 0, 1])
        assert engine.intersects_location(origins, directions, multiple_hits=False)[1].tolist() == [0, 2]
        faces, rays, locations = engine.intersects_id(origins, directions, multiple_hits=False, return_locations=True)
        assert rays.tolist() == [0, 2] and locations.shape == (2, 3)
        assert len(engine.intersects_id(origins, directions)) == 2
        first = engine.intersects_first(origins, directions)
        assert first.tolist() == [faces[0], -1, faces[1]]
        assert engine.intersects_any(origins, directions).tolist() == [True, False, True]
    by_place = (origins, directions, False, 100, True)  # multiple hits, at most so many, locations
    assert len(mesh.ray.intersects_id(*by_place)) == 3
    by_place = (origins, directions, True, False)  # locations, multiple hits
    assert len(kerf_bvh.trimesh.RayTriangleIntersector(mesh).intersects_id(*by_place)[1]) == 2
    assert mesh.ray.intersects_id(origins, directions, max_hits=1)[1].tolist() == [0, 2]


def test_nothing_hit_and_nothing_asked_are_arrays_of_the_right_shapes():
    mesh = box()
    for origins in ([[9.0, 9, 9]], []):
        directions = np.ones_like(origins)
        locations, rays, faces = mesh.ray.intersects_location(origins, directions)
        assert locations.shape == (0, 3) and rays.shape == faces.shape == (0,)
    assert mesh.contains([]).shape == (0,) and mesh.nearest.on_surface([])[0].shape == (0, 3)
    with pytest.raises(ValueError, match="don't match"):
        mesh.ray.intersects_any([[0, 0, 0]], [[0, 0, 1]] * 2)
    with pytest.raises(ValueError, match="points must be"):
        mesh.nearest.on_surface([[0, 0]])


@pytest.mark.parametrize("scale", [1e-4, 1e-3, 1.0, 1e4, 1e8])
def test_every_scale_has_each_hit_once(scale):
    mesh = box(scale)
    rays = [[0, 0, 1e4 * scale]], [[0, 0, -1]]
    assert len(mesh.ray.intersects_id(*rays)[0]) == 2
    on_top = [[0, 0, scale / 2]], [[0, 0, -1]]
    assert len(mesh.ray.intersects_id(*on_top)[0]) == 2


def test_edges_vertices_and_diagonals_are_hit_and_first_agrees_with_any():
    mesh = box()
    outer = trimesh.creation.box(extents=[3, 3, 3]).subdivide_to_size(0.5)
    origins = np.zeros_like(outer.vertices)
    assert mesh.ray.intersects_any(origins, outer.vertices).all()
    assert (mesh.ray.intersects_first(origins, outer.vertices) >= 0).all()
    assert len(mesh.ray.intersects_id(origins, outer.vertices)[1]) == len(origins)
    rims = np.array([[1, 0, 5], [0, -1, 5], [1, 1, 5], [-1, 1, 5]], float)
    assert mesh.ray.intersects_any(rims, np.tile([0, 0, -1.0], (4, 1))).all()


def test_a_ray_that_begins_on_the_surface_and_leaves_it_hits_nothing():
    mesh = box()
    points, faces = trimesh.sample.sample_surface(mesh, 500, seed=0)
    outwards = mesh.face_normals[faces]
    assert not mesh.ray.intersects_any(points, outwards).any()
    assert len(mesh.ray.intersects_id(points, outwards)[0]) == 0
    through = mesh.ray.intersects_location(points, -outwards, multiple_hits=True)
    assert np.bincount(through[1]).tolist() == [2] * 500
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.apply_translation([5000.1, -300.7, 40.3])
    kerf_bvh.trimesh.use(ball)
    points, faces = trimesh.sample.sample_surface(ball, 2000, seed=0)
    assert not ball.ray.intersects_any(points, ball.face_normals[faces]).any()


def test_a_wall_at_surveyed_coordinates_is_not_hit_from_a_centimetre_away():
    corners = np.array(
        [[528980.85, 183526.1, 0], [528980.85, 183526.1, 3], [528982.3, 183523.55, 0], [528982.3, 183523.55, 3]]
    )
    wall = trimesh.Trimesh(corners, [[1, 0, 2], [1, 2, 3]], process=False)
    kerf_bvh.trimesh.use(wall)
    origin = corners[[0, 2]].mean(axis=0) + [0, 0, 1] + 0.01 * wall.face_normals[0]
    assert not wall.ray.intersects_any([origin], wall.face_normals[:1])[0]
    location, _, _ = wall.ray.intersects_location([origin], -wall.face_normals[:1])
    assert np.linalg.norm(location[0] - origin) == pytest.approx(0.01, abs=1e-8)


def test_a_ray_in_the_plane_of_a_sheet_hits_nothing():
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 3, 0], [0, 3, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    kerf_bvh.trimesh.use(sheet)
    assert sheet.ray.intersects_location([[-5, 1, 0]], [[1, 0, 0]], multiple_hits=False)[0].shape == (0, 3)


def test_inside_is_told_by_parity_also_in_a_cavity():
    outer, inner = trimesh.creation.box(extents=[2] * 3), trimesh.creation.box(extents=[1] * 3)
    inner.invert()
    hollow = trimesh.util.concatenate([outer, inner])
    kerf_bvh.trimesh.use(hollow)
    assert hollow.contains([[0, 0, 0], [0.75, 0, 0], [2, 0, 0]]).tolist() == [False, True, False]
    assert kerf_bvh.trimesh.contains(hollow, [[0.75, 0, 0]]).all()


def test_closest_points_are_those_of_a_naive_search(random):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.apply_translation([1000.3, 20.1, -7.7])
    points = mesh.centroid + random.normal(size=(300, 3))
    closest, distances, faces = kerf_bvh.trimesh.closest_point(mesh, points)
    expected, expected_distances, _ = trimesh.proximity.closest_point_naive(mesh, points)
    assert closest.dtype == distances.dtype == np.float64 and faces.dtype == np.int64
    assert np.allclose(distances, expected_distances, atol=1e-10) and np.allclose(closest, expected, atol=1e-7)


def test_a_point_before_an_edge_has_the_face_that_looks_at_it():
    sharp = trimesh.Trimesh(
        [[-1, 0.5, 0], [1, 0.5, 0], [0, -1, -0.5], [0, -1, 0.5]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [3, 2, 1]]
    )
    points = np.transpose([np.zeros(20), np.ones(20), np.linspace(-1, 1, 20)])
    faces = kerf_bvh.trimesh.closest_point(sharp, points)[2]
    assert len(set(faces[:10])) == len(set(faces[10:])) == 1 and faces[0] != faces[-1]


def test_signed_distance_is_positive_inside_as_in_trimesh():
    mesh = box(1.0)
    distances = mesh.nearest.signed_distance([[0, 0, 0], [100, 0.5, 0.5], [0, 0, 0.5], [3, 3, 3]])
    assert distances == pytest.approx([0.5, -99.5, 0, -np.sqrt(18.75)])
    assert kerf_bvh.trimesh.bvh_of(mesh).signed_distance([0, 0, 0]) == -0.5


def test_a_changed_mesh_is_built_anew_and_an_unchanged_one_is_not():
    mesh = box()
    before = kerf_bvh.trimesh.bvh_of(mesh)
    assert kerf_bvh.trimesh.bvh_of(mesh) is before
    mesh.apply_scale(1 / 64)
    assert not mesh.contains([[0.5, 0.5, 0.5]])[0] and mesh.contains([[0.01, 0.01, 0.01]])[0]


def test_copies_and_pickles_of_a_mesh_answer(everywhere):
    mesh = trimesh.creation.box(extents=[2, 2, 2])
    mesh.contains([[0, 0, 0]])
    for other in (mesh.copy(), copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
        assert isinstance(other.ray, kerf_bvh.trimesh.RayMeshIntersector)
        assert other.contains([[0, 0, 0]])[0] and other.nearest.signed_distance([[0, 0, 0]])[0] == 1


def test_all_of_trimesh_takes_it_and_gives_it_back(everywhere):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    assert isinstance(mesh.ray, kerf_bvh.trimesh.RayMeshIntersector)
    assert isinstance(mesh.nearest, kerf_bvh.trimesh.ProximityQuery)
    thickness = trimesh.proximity.thickness(mesh, mesh.triangles_center[:5], method="ray")
    assert thickness == pytest.approx([2] * 5, abs=0.1)
    assert mesh.nearest.vertex(mesh.vertices[:3])[1].tolist() == [0, 1, 2]
    kerf_bvh.trimesh.restore()
    assert not isinstance(trimesh.creation.box().ray, kerf_bvh.trimesh.RayMeshIntersector)
    assert trimesh.proximity.closest_point is not kerf_bvh.trimesh.closest_point
