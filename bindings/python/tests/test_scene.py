"""Scenes against one mesh of all transformed copies."""

import pickle
import re
import threading

import numpy as np
import pytest
import support

import kerf_bvh

VERTICES, FACES = support.sphere(12, 16)
VERTICES = np.round(VERTICES * 64).astype(np.float32) / 64  # floats hold them under the transforms below


def exact_transforms(count, rng):
    """Quarter turns, powers of two and whole steps: floats hold what they make of the vertices."""
    maps = np.zeros((count, 3, 4))
    for matrix in maps:
        matrix[np.arange(3), rng.permutation(3)] = rng.choice([-1, 1], 3) * 2.0 ** rng.integers(-1, 2)
        matrix[:, 3] = rng.integers(-8, 9, 3)
    return maps


def any_transforms(count, rng):
    maps = np.empty((count, 3, 4))
    for matrix in maps:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        shear = np.eye(3) + np.triu(rng.uniform(-0.5, 0.5, (3, 3)), 1)
        matrix[:, :3] = turn @ shear @ np.diag(rng.uniform(0.3, 2, 3))
        matrix[:, 3] = rng.uniform(-8, 8, 3)
    return maps


def moved(maps, vertices):
    return np.einsum("nij,vj->nvi", maps[:, :, :3], vertices) + maps[:, None, :, 3]


def merged(maps, vertices=VERTICES, faces=FACES):
    """One mesh for each instance."""
    return kerf_bvh.Bvh.from_meshes([(copy.astype(np.float32), faces) for copy in moved(maps, vertices)])


@pytest.fixture(scope="module")
def ball():
    return kerf_bvh.Bvh(VERTICES, FACES)


def rays(rng, count=4000):
    origins = np.round(rng.uniform(-12, 12, (count, 3)) * 64).astype(np.float32) / 64
    return origins, rng.normal(size=(count, 3)).astype(np.float32)


@pytest.mark.parametrize("shape", [(3, 4), (4, 4)])
def test_where_floats_hold_the_copies_rays_hit_as_in_one_mesh(ball, random, shape):
    maps = exact_transforms(40, random)
    given = np.tile(np.eye(4), (40, 1, 1))
    given[:, :3] = maps
    scene, mesh = kerf_bvh.Scene(ball, given[:, : shape[0]]), merged(maps)
    origins, directions = rays(random)
    hits, expected = scene.intersect(origins, directions), mesh.intersect(origins, directions)
    assert hits.hit.sum() > 100
    assert np.array_equal(hits.t, expected.t)
    assert np.array_equal(hits.instance, expected.mesh)
    assert (hits.primitive == expected.primitive).mean() > 0.999  # a mirrored copy may hit the other one at an edge
    assert np.array_equal(scene.occluded(origins, directions), expected.hit)
    assert np.array_equal(scene.count_hits(origins, directions), mesh.count_hits(origins, directions))
    lists, all_expected = scene.all_hits(origins, directions), mesh.all_hits(origins, directions)
    assert np.array_equal(lists.offsets, all_expected.offsets)
    assert np.array_equal(lists.items.t, all_expected.items.t)
    assert np.array_equal(scene.contains(origins), mesh.contains(origins))


def test_boxes_hold_the_triangles_that_they_hold_of_one_mesh(ball, random):
    for maps in (exact_transforms(30, random), any_transforms(30, random)):
        scene, mesh = kerf_bvh.Scene(ball, maps), merged(maps)
        corners = random.uniform(-8, 8, (300, 1, 3)).astype(np.float32)
        boxes = np.concatenate([corners, corners + random.uniform(0, 3, (300, 1, 3)).astype(np.float32)], axis=1)
        lists, expected = scene.triangles_in(boxes), mesh.triangles_in(boxes)
        assert len(lists.items) > 1000
        assert np.array_equal(lists.offsets, expected.offsets)
        assert np.array_equal(lists.items.instance, expected.items.mesh)
        assert np.array_equal(lists.items.primitive, expected.items.primitive)
        assert not lists.items.mesh.any()
    with pytest.raises(ValueError, match="boxes: shape"):
        scene.triangles_in(corners)


@pytest.mark.parametrize("read", [kerf_bvh.Scene.load, kerf_bvh.Scene.map])
def test_a_file_holds_the_same_scene_and_each_object_once(tmp_path, ball, random, read):
    far = kerf_bvh.Bvh(VERTICES.astype(np.float64) + [4.3e5, 5.4e6, 300], FACES)
    row = kerf_bvh.Scene([ball, far], any_transforms(40, random), which=random.integers(0, 2, 40), numbers=np.arange(40))
    town = kerf_bvh.Scene([row, ball], any_transforms(9, random), which=[0, 1, 0, 0, 0, 0, 1, 0, 0], masks=np.arange(9))
    town.save(tmp_path / "town.kerf")
    again = read(tmp_path / "town.kerf")
    origins, directions = rays(random, 500)
    assert np.array_equal(again.intersect(origins, directions).t, town.intersect(origins, directions).t)
    assert len(again.objects) == 2 and len(again.objects[0].objects) == 2
    assert again.objects[1] in again.objects[0].objects  # the ball is one object still
    assert np.array_equal(again.masks, town.masks) and np.array_equal(again.which, town.which)
    inner = again.objects[0]
    assert np.array_equal(inner.numbers, row.numbers)
    scale = np.abs(row.transforms).max(axis=(1, 2)) + 5.4e6
    assert (np.abs(inner.transforms - row.transforms).max(axis=(1, 2)) < 1e-14 * scale).all()
    far.save(tmp_path / "far.kerf")
    assert read(tmp_path / "far.kerf").instance_count == 1
    with pytest.raises(ValueError, match="load it as a scene"):
        kerf_bvh.Bvh.load(tmp_path / "town.kerf")
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "none.kerf")


def test_touching_pairs_are_those_of_the_meshes(ball, random):
    maps, others = any_transforms(12, random), any_transforms(10, random)
    maps[:, :, 3] /= 4
    others[:, :, 3] /= 4
    scene, other = kerf_bvh.Scene(ball, maps), kerf_bvh.Scene(ball, others)
    pairs, expected = scene.touching_pairs(other), merged(maps).touching_pairs(merged(others))
    assert len(pairs) > 50 and scene.touches(other)
    for mine, theirs in ((pairs.first, expected.first), (pairs.second, expected.second)):
        assert np.array_equal(mine.instance, theirs.mesh)
        assert np.array_equal(mine.primitive, theirs.primitive)
    own, mesh = scene.touching_pairs(), merged(maps)
    all_pairs = mesh.touching_pairs(mesh)
    assert len(own) == (all_pairs.first.mesh < all_pairs.second.mesh).sum() > 0
    assert len(scene.touching_pairs(ball, others[0])) == (pairs.second.instance == 0).sum()
    assert not scene.touches(ball, np.eye(4)[:3] + [[0, 0, 0, 100]] * 3)
    with pytest.raises(ValueError, match="transform: one for no other"):
        scene.touching_pairs(transform=np.eye(4))
    with pytest.raises(TypeError, match="other: int"):
        scene.touches(7)


def test_points_are_answered_as_in_one_mesh_under_any_transform(ball, random):
    maps = any_transforms(30, random)
    scene, mesh = kerf_bvh.Scene(ball, maps), merged(maps)
    points = random.uniform(-10, 10, (1000, 3))
    closest, expected = scene.closest_point(points), mesh.closest_point(points)
    assert closest.position.dtype == np.float64
    assert np.allclose(closest.distance, expected.distance, atol=1e-5)
    assert np.allclose(np.linalg.norm(closest.position - points, axis=1), closest.distance, atol=1e-5)
    assert not scene.closest_point(points, 1e-9).found.any()
    inside = scene.contains(points)
    assert (inside == mesh.contains(points)).mean() > 0.998  # within the rounding of a surface
    assert np.array_equal(scene.signed_distance(points), np.where(inside, -closest.distance, closest.distance))
    lists, all_expected = scene.within(points, 1.5), mesh.within(points, 1.5)
    assert abs(len(lists.items) - len(all_expected.items)) <= 5
    assert all(np.all(np.diff(near.distance) >= 0) for near in lists)
    hits = scene.intersect(points, -points)
    far = mesh.intersect(points, -points)
    assert np.allclose(hits.t, far.t, atol=1e-4)


def test_geometry_and_triangles_are_those_of_one_mesh(ball, random):
    for maps in (exact_transforms(40, random), any_transforms(40, random)):
        scene, mesh = kerf_bvh.Scene(ball, maps), merged(maps)
        origins, directions = rays(random, 1000)
        hits = scene.intersect(origins, directions)
        met = scene.geometry(origins, directions, hits)
        flat = kerf_bvh.Hits(hits.t, hits.u, hits.v, hits.primitive, hits.instance)
        expected = mesh.geometry(origins, directions, flat)
        assert hits.hit.sum() > 50
        assert np.allclose(met.corners, expected.corners, rtol=1e-6, atol=1e-6, equal_nan=True)
        assert np.allclose(met.normal, expected.normal, atol=2e-3, equal_nan=True)
        assert (met.front == expected.front).mean() > 0.998  # where a ray grazes a triangle, rounding decides
        assert np.isnan(met.corners[~hits.hit]).all() and np.isnan(met.normal[~hits.hit]).all()
        corners = scene.triangles(hits.primitive[hits.hit], instance=hits.instance[hits.hit])
        assert np.array_equal(corners, met.corners[hits.hit])
    assert scene.triangles(3).shape == (3, 3) and scene.triangles([[1, 2]], 0, [[5], [6]]).shape == (2, 2, 3, 3)
    assert np.isnan(scene.triangles([0, 0, len(FACES)], [0, 1, 0], [40, 0, 0])).all()
    with pytest.raises(ValueError, match="hits: shape"):
        scene.geometry(origins[:3], directions[:3], hits)
    with pytest.raises(TypeError, match="primitive: elements of type float64"):
        scene.triangles(0.5)


def test_rays_pass_instances_that_are_not_accepted(ball, random):
    maps = any_transforms(40, random)
    scene = kerf_bvh.Scene([kerf_bvh.Scene(ball, maps), ball], which=[0, 1])
    accept = random.integers(0, 2, 41).astype(bool)
    rest = kerf_bvh.Scene(ball, np.concatenate([maps, np.eye(4)[None, :3]])[accept])
    origins, directions = rays(random)
    hits, expected = scene.intersect(origins, directions, accept=accept), rest.intersect(origins, directions)
    assert expected.hit.sum() > 100
    assert np.allclose(hits.t, expected.t, atol=1e-4)
    assert np.array_equal(hits.instance[hits.hit], np.flatnonzero(accept)[expected.instance[hits.hit]])
    assert np.array_equal(scene.occluded(origins, directions, accept=accept), hits.hit)
    with pytest.raises(ValueError, match=re.escape("accept: shape (40,) for 41 instances")):
        scene.intersect(origins, directions, accept=accept[1:])
    with pytest.raises(TypeError, match="accept: elements of type int64"):
        scene.occluded(origins, directions, accept=accept.astype(np.int64))


def test_rays_pass_triangles_that_are_not_accepted_wherever_their_object_stands(ball, cube, random):
    maps = any_transforms(30, random)
    accept = random.integers(0, 2, len(FACES)).astype(bool)

    def scene_of(round):
        group = kerf_bvh.Scene([round, cube], maps[:20], which=np.arange(20) % 2)
        places = np.concatenate([np.eye(4)[None, :3], maps[20:]])
        return kerf_bvh.Scene([group, round, cube], places, which=[0, 1, 2] + 8 * [1])

    is_round = np.array(10 * [True, False] + [True, False] + 8 * [True])
    scene, rest = scene_of(ball), scene_of(kerf_bvh.Bvh(VERTICES, FACES[accept]))
    origins, directions = rays(random)
    expected = rest.intersect(origins, directions)
    primitive = expected.primitive.copy()
    renamed = expected.hit & is_round[np.where(expected.hit, expected.instance, 0)]
    assert renamed.sum() > 100 and (expected.hit & ~renamed).sum() > 10
    primitive[renamed] = np.flatnonzero(accept)[primitive[renamed]]
    for given in (accept, [accept]):
        hits = scene.intersect(origins, directions, accept_triangles={ball: given})
        assert np.array_equal(hits.t, expected.t) and np.array_equal(hits.instance, expected.instance)
        assert np.array_equal(hits.primitive, primitive)
    assert np.array_equal(scene.occluded(origins, directions, accept_triangles={ball: accept}), hits.hit)

    both = {cube: np.zeros(12, bool), ball: accept}
    there = is_round & (random.uniform(size=30) < 0.7)
    hits = scene.intersect(origins, directions, accept=there, accept_triangles=both)
    expected = rest.intersect(origins, directions, accept=there)
    assert np.array_equal(hits.t, expected.t) and np.array_equal(hits.instance, expected.instance)
    hits, expected = scene.intersect(origins, directions, accept_triangles={}), scene.intersect(origins, directions)
    assert np.array_equal(hits.t, expected.t)
    with pytest.raises(ValueError, match=re.escape("accept: shape (3,) for the 12 triangles of mesh 0")):
        scene.intersect(origins, directions, accept_triangles={cube: np.ones(3, bool)})
    with pytest.raises(ValueError, match="accept_triangles: an object that does not stand in the scene"):
        scene.occluded(origins, directions, accept_triangles={kerf_bvh.Bvh(VERTICES, FACES): accept})


def test_the_nearest_are_the_first_within_and_sides_tell_the_surface(ball, cube, random):
    scene = kerf_bvh.Scene(ball, any_transforms(30, random))
    points = random.uniform(-8, 8, (100, 3))
    nearest, every = scene.nearest(points, 7), scene.within(points, np.inf)
    assert len(nearest.items) == 700
    for some, every_one in zip(nearest, every):
        for name in ("distance", "instance", "primitive"):
            assert np.array_equal(getattr(some, name), getattr(every_one, name)[:7])
    assert len(scene.nearest(points, 7, 1e-9).items) == 0 and len(scene.nearest(points, 0).items) == 0
    with pytest.raises(ValueError, match="count: -1"):
        scene.nearest(points, -1)
    boxes = kerf_bvh.Scene(cube, np.array([[[2.0, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]]))
    sides = boxes.side([[[1, 1, 1], [2, 1, 1], [2.5, 1, 1]]])
    assert sides.tolist() == [[kerf_bvh.Side.INSIDE, kerf_bvh.Side.ON, kerf_bvh.Side.OUTSIDE]]


def test_masks_and_numbers_are_those_of_instances(ball):
    maps = np.tile(np.eye(4), (3, 1, 1))
    maps[:, 2, 3] = [0, 3, 6]
    scene = kerf_bvh.Scene(ball, maps, masks=[1, 2, 4], numbers=[70, 80, 90])
    down = ([0, 0.1, 20], [0, 0, -1])
    assert scene.numbers[scene.intersect(*down).instance] == 90
    assert scene.intersect(*down, mask=3).instance == 1
    assert scene.intersect(*down, mask=8).instance == kerf_bvh.INVALID
    assert scene.occluded(*down, mask=4) and not scene.occluded(*down, mask=8)
    many = scene.intersect(np.tile(down[0], (4, 1)), down[1], mask=np.array([1, 2, 4, 8]))
    assert many.instance.tolist() == [0, 1, 2, kerf_bvh.INVALID]
    assert scene.masks.tolist() == [1, 2, 4] and scene.instance_count == 3


def test_scenes_stand_in_scenes_and_paths_name_them(ball, cube, random):
    row = kerf_bvh.Scene([ball, cube], [np.eye(4)[:3], [[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0]]])
    steps = np.tile(np.eye(4), (3, 1, 1))
    steps[:, 1, 3] = [0, 10, 20]
    field = kerf_bvh.Scene([row, ball], steps, which=[0, 1, 0])
    assert field.instance_count == 5
    hit = field.intersect([4.5, 20.25, 9], [0, 0, -1])
    assert hit.t == 8 and field.path(int(hit.instance)) == (2, 1)
    assert field.path(2) == (1,)
    flat = kerf_bvh.Scene(
        [ball, cube, ball, ball, cube],
        np.array([steps[0], steps[0], steps[1], steps[2], steps[2]])
        + [[[0, 0, 0, x], [0] * 4, [0] * 4, [0] * 4] for x in (0, 4, 0, 0, 4)],
    )
    origins, directions = rays(random)
    a, b = field.intersect(origins, directions), flat.intersect(origins, directions)
    assert np.array_equal(a.t, b.t) and np.array_equal(a.instance, b.instance)
    assert field.bounds[1, 1] >= 21 and "5 instances" in repr(field) and field.bytes > 0


def test_objects_far_from_the_origin_are_placed_by_their_own_coordinates(random):
    place = np.array([500_000.25, 4_600_000.5, 100.0])
    far = kerf_bvh.Bvh(VERTICES.astype(np.float64) + place, FACES)
    back = np.eye(4)
    back[:3, 3] = -place
    turned = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 5]])
    scene = kerf_bvh.Scene(far, [back, np.vstack([turned, [0, 0, 0, 1]]) @ back])
    near = kerf_bvh.Scene(kerf_bvh.Bvh(VERTICES, FACES), [np.eye(4), np.vstack([turned, [0, 0, 0, 1]])])
    origins, directions = rays(random)
    assert np.allclose(scene.intersect(origins, directions).t, near.intersect(origins, directions).t, atol=1e-3)


def test_answers_have_the_shape_of_the_questions_and_nothing_is_allowed(ball):
    scene = kerf_bvh.Scene(ball)
    origins = np.zeros((4, 5, 3)) + [0, 0.1, 9]
    assert scene.intersect(origins, [0, 0, -1]).instance.shape == (4, 5)
    assert scene.closest_point(origins).position.shape == (4, 5, 3)
    assert scene.intersect(origins[0, 0], [0, 0, -1])[()].hit
    assert len(scene.within(origins, 1)) == 20
    for nothing in (kerf_bvh.Scene(), kerf_bvh.Scene([]), kerf_bvh.Scene(kerf_bvh.Bvh()), kerf_bvh.Scene(ball, np.empty((0, 3, 4)))):
        assert not nothing.occluded(origins, [0, 0, -1]).any()
        assert np.isinf(nothing.signed_distance(origins)).all()
        assert nothing.bounds is None and len(nothing.all_hits(origins, [0, 0, -1]).items) == 0


def test_the_same_answers_for_any_number_of_threads_and_after_pickling(ball, random):
    scene = kerf_bvh.Scene(ball, any_transforms(50, random), numbers=np.arange(50), threads=1)
    again = pickle.loads(pickle.dumps(scene))
    origins, directions = rays(random)
    hits = scene.intersect(origins, directions)
    for other in (scene.intersect(origins, directions, threads=1), again.intersect(origins, directions, threads=2)):
        assert np.array_equal(hits.t, other.t) and np.array_equal(hits.instance, other.instance)
    assert np.array_equal(again.numbers, scene.numbers) and np.array_equal(again.transforms, scene.transforms)


def test_what_cannot_stand_in_a_scene_is_refused(ball):
    def refused(kind, sentence):
        return pytest.raises(kind, match=re.escape(sentence))

    with refused(TypeError, "objects: int, where a Bvh or a Scene is needed"):
        kerf_bvh.Scene([3])
    with refused(ValueError, "transforms: shape (2, 3), where (3, 4) or (4, 4) is needed"):
        kerf_bvh.Scene(ball, np.zeros((2, 3)))
    with refused(ValueError, "transforms: its last row is [0.0, 1.0, 0.0, 1.0], where an affine map has [0, 0, 0, 1]"):
        projective = np.tile(np.eye(4), (2, 1, 1))
        projective[1, 3, 1] = 1
        kerf_bvh.Scene(ball, projective)
    with refused(ValueError, "objects: 2 of them for 3 transforms"):
        kerf_bvh.Scene([ball, ball], np.tile(np.eye(4), (3, 1, 1)))
    with refused(ValueError, "which: 2, but there are only 2 objects"):
        kerf_bvh.Scene([ball, ball], which=[0, 2])
    with refused(ValueError, "which: shape (2,), where one number or (3,) is needed"):
        kerf_bvh.Scene([ball, ball], np.tile(np.eye(4), (3, 1, 1)), which=[0, 1])
    with refused(ValueError, "the transform of instance 0 flattens its object"):
        kerf_bvh.Scene(ball, np.diag([1.0, 1, 0, 1]))
    with refused(ValueError, "the transform of instance 0 has a number that is not finite"):
        kerf_bvh.Scene(ball, np.diag([1.0, 1, np.nan, 1]))
    with refused(ValueError, "instance: -1"):
        kerf_bvh.Scene(ball).path(-1)
    with pytest.raises(ValueError):
        kerf_bvh.Scene(ball).path(1)
    deep = ball
    for _ in range(8):
        deep = kerf_bvh.Scene(deep)
    with refused(ValueError, "9 levels of scenes are more than 8"):
        kerf_bvh.Scene(deep)


# Refits


def bent(vertices, by=0.2):
    return vertices + by * np.sin(3 * vertices[:, [1, 2, 0]])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_refit_answers_as_a_new_build(random, dtype):
    bvh = kerf_bvh.Bvh(VERTICES.astype(dtype), FACES)
    moved_vertices = bent(VERTICES).astype(dtype)
    report = bvh.refit(moved_vertices, FACES)
    assert 0.8 < report.cost_ratio < 1.5 and not report.rebuilt
    built = kerf_bvh.Bvh(moved_vertices.astype(np.float32), FACES)
    origins, directions = rays(random)
    hits, expected = bvh.intersect(origins, directions), built.intersect(origins, directions)
    assert hits.hit.any()
    assert np.array_equal(hits.t, expected.t) and np.array_equal(hits.primitive, expected.primitive)
    assert np.array_equal(bvh.contains(origins / 8), built.contains(origins / 8))
    assert np.array_equal(bvh.triangles(range(len(FACES))), moved_vertices.astype(np.float32)[FACES])


def test_a_refit_far_from_the_origin_stays_in_its_frame(random):
    place = np.array([500_000.25, 4_600_000.5, 100.0])
    bvh = kerf_bvh.Bvh(VERTICES.astype(np.float64) + place, FACES.astype(np.int64))
    origin = bvh.origin
    report = bvh.refit(bent(VERTICES).astype(np.float64) + place, FACES.astype(np.int64))
    assert not report.rebuilt and np.array_equal(bvh.origin, origin)
    near = kerf_bvh.Bvh(bent(VERTICES).astype(np.float32), FACES)
    points = random.uniform(-1.5, 1.5, (500, 3))
    assert np.allclose(bvh.signed_distance(points + place), near.signed_distance(points), atol=1e-4)


def test_meshes_corners_and_masks_are_refitted():
    corners = VERTICES[FACES]
    bvh = kerf_bvh.Bvh.from_meshes([(VERTICES, FACES), corners + np.float32([0, 0, 5])], masks=[1, 2])
    down = ([0.01, 0.02, 20], [0, 0, -1])
    bvh.refit_meshes([(VERTICES, FACES), corners + np.float32([0, 0, 9])])
    assert bvh.intersect(*down).t < 11 and bvh.intersect(*down, mask=1).t > 18
    single = kerf_bvh.Bvh(corners)
    single.refit(corners * 2)
    assert np.array_equal(single.bounds, single.bounds) and single.bounds[1, 2] == 2 * corners.max()


def test_a_triangle_that_gets_an_area_has_the_hierarchy_built_anew():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[5, 0, 0], [5, 0, 0], [5, 1, 0]]], np.float32)
    bvh = kerf_bvh.Bvh(corners)
    assert bvh.statistics.degenerate_triangles == 1
    corners[1, 1, 0] = 6
    assert bvh.refit(corners) == kerf_bvh.RefitReport(cost_ratio=1.0, rebuilt=True)
    assert bvh.occluded([5.25, 0.25, 1], [0, 0, -1])


def test_what_a_refit_refuses_changes_nothing(ball):
    bvh = kerf_bvh.Bvh(VERTICES, FACES)
    for vertices, faces, sentence in [
        (VERTICES, FACES[1:], "mesh 0 has 351 triangles, but 352 when the hierarchy was built"),
        (VERTICES[:5], FACES, "names vertex"),
        (np.full_like(VERTICES, np.nan), FACES, r"is \(nan, nan, nan\)"),
        (VERTICES, None, "faces: none"),
    ]:
        with pytest.raises(ValueError, match=sentence):
            bvh.refit(vertices, faces)
    with pytest.raises(ValueError, match="2 meshes"):
        bvh.refit_meshes([(VERTICES, FACES)] * 2)
    with pytest.raises(ValueError, match="alpha"):
        bvh.refit(VERTICES, FACES, alpha=2.0)
    assert bvh.contains([0, 0, 0]) and np.array_equal(bvh.bounds, ball.bounds)


def test_a_scene_keeps_an_object_as_it_was_when_it_is_refitted():
    bvh = kerf_bvh.Bvh(VERTICES, FACES)
    scene = kerf_bvh.Scene(bvh)
    bvh.refit(VERTICES * np.float32(2), FACES)
    assert bvh.contains([0, 0, 1.5]) and not scene.contains([0, 0, 1.5])
    assert kerf_bvh.Scene(bvh).contains([0, 0, 1.5])


def test_threads_ask_while_one_refits_and_see_one_state_or_the_other(random):
    bvh = kerf_bvh.Bvh(VERTICES, FACES)
    sizes = (np.float32(1), np.float32(2))
    origins = np.tile(np.array([[0.1, 0.2, 9]], np.float32), (20_000, 1))
    expected = {float(kerf_bvh.Bvh(VERTICES * size, FACES).intersect(origins[0], [0, 0, -1]).t) for size in sizes}
    done, wrong = threading.Event(), []

    def ask():
        while not done.is_set():
            t = np.unique(bvh.intersect(origins, [0, 0, -1], threads=1).t)
            if len(t) != 1 or float(t[0]) not in expected:
                wrong.append(t)

    askers = [threading.Thread(target=ask) for _ in range(3)]
    for asker in askers:
        asker.start()
    for i in range(200):
        bvh.refit(VERTICES * sizes[i % 2], FACES)
    done.set()
    for asker in askers:
        asker.join()
    assert not wrong
