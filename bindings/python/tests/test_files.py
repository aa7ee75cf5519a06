"""Files and pickles hold the same hierarchy."""

import copy
import pickle

import numpy as np
import pytest
import support

import kerf_bvh


@pytest.mark.parametrize("read", [kerf_bvh.Bvh.load, kerf_bvh.Bvh.map, lambda path: kerf_bvh.Bvh.load(str(path))])
def test_a_file_holds_the_same_hierarchy(tmp_path, ball, random, read):
    ball.save(tmp_path / "ball.kerf")
    points = random.normal(size=(100, 3))
    assert np.array_equal(read(tmp_path / "ball.kerf").signed_distance(points), ball.signed_distance(points))


def test_a_pickle_holds_the_same_hierarchy_and_its_frame(random):
    vertices, faces = support.sphere()
    far = kerf_bvh.Bvh(vertices + [431_200.1, 5_412_800.7, 320], faces)
    points = vertices[:50] * 1.5 + [431_200.1, 5_412_800.7, 320]
    for other in (pickle.loads(pickle.dumps(far)), copy.deepcopy(far)):
        assert np.array_equal(other.origin, far.origin)
        assert np.array_equal(other.closest_point(points).position, far.closest_point(points).position)


def test_files_and_pickles_hold_masks(tmp_path):
    masked = kerf_bvh.Bvh.from_meshes([(support.CUBE_VERTICES, support.CUBE_FACES)], masks=[2])
    masked.save(tmp_path / "masked.kerf")
    for other in (pickle.loads(pickle.dumps(masked)), kerf_bvh.Bvh.load(tmp_path / "masked.kerf")):
        ray = [0.25, 0.5, 2], [0, 0, -1]
        assert other.occluded(*ray, mask=2) and not other.occluded(*ray, mask=1)


def test_files_that_are_not_right_are_refused(tmp_path, cube):
    with pytest.raises(FileNotFoundError):
        kerf_bvh.Bvh.load(tmp_path / "none.kerf")
    with pytest.raises(IsADirectoryError):
        kerf_bvh.Bvh.map(tmp_path)
    (tmp_path / "text.kerf").write_text("not a hierarchy at all, but long enough to have a header" * 10)
    with pytest.raises(ValueError, match="text.kerf"):
        kerf_bvh.Bvh.load(tmp_path / "text.kerf")
    with pytest.raises(OSError, match="none"):
        cube.save(tmp_path / "none" / "cube.kerf")
