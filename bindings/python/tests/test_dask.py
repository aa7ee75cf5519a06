"""Dask: chunk by chunk the same answers, in processes that share the memory of one file."""

import subprocess
import sys
from pathlib import Path

import dask.array as da
import numpy as np
import pytest
import support
from distributed import Client, LocalCluster

import kerf_bvh
import kerf_bvh.dask


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("dask") / "ball.kerf"
    kerf_bvh.Bvh(*support.sphere()).save(path)
    return path


def test_answers_are_those_without_dask(path, ball, random):
    mapped = kerf_bvh.dask.MappedBvh(path)
    origins, directions = random.normal(size=(1000, 3)), random.normal(size=(1000, 3))
    chunked, along = da.from_array(origins, chunks=(300, 2)), da.from_array(directions, chunks=(500, 3))
    hits, expected = mapped.intersect(chunked, along).compute(), ball.intersect(origins, directions)
    for name in hits.dtype.names:
        assert np.array_equal(hits[name], getattr(expected, name))
    blocked = mapped.occluded(chunked, along, t_max=1.0).compute()
    assert np.array_equal(blocked, ball.occluded(origins, directions, t_max=1.0))
    assert np.array_equal(mapped.count_hits(chunked, along).compute(), ball.count_hits(origins, directions))
    assert np.array_equal(mapped.contains(chunked).compute(), ball.contains(origins))
    assert np.array_equal(mapped.signed_distance(chunked).compute(), ball.signed_distance(origins))
    closest, expected = mapped.closest_point(chunked).compute(), ball.closest_point(origins)
    for name in closest.dtype.names:
        assert np.array_equal(closest[name], getattr(expected, name))


def test_what_cannot_be_asked_is_refused_at_once(path, tmp_path):
    mapped = kerf_bvh.dask.MappedBvh(path)
    with pytest.raises(ValueError, match=r"^points: shape \(4, 2\), where \(n, 3\) is needed"):
        mapped.contains(da.zeros((4, 2)))
    with pytest.raises(ValueError, match="^origins and directions: shapes"):
        mapped.occluded(da.zeros((4, 3)), da.zeros((5, 3)))
    with pytest.raises(FileNotFoundError):
        kerf_bvh.dask.MappedBvh(tmp_path / "none.kerf")


def maps(path):
    return str(path) in Path("/proc/self/maps").read_text()


def test_two_processes_map_one_file(path, ball, random):
    points = random.normal(size=(4000, 3))
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            mapped = kerf_bvh.dask.MappedBvh(path)
            distances = mapped.signed_distance(da.from_array(points, chunks=(100, 3))).compute()
            assert np.array_equal(distances, ball.signed_distance(points))
            assert list(client.run(maps, path).values()) == [True, True]


def test_the_example_bakes_what_the_sky_shows():
    script = Path(__file__).parent.parent / "examples" / "bake_visibility.py"
    command = [sys.executable, str(script), "20000", "--rays", "4"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert 50 < float(result.stdout.split("points see")[1].split("%")[0]) < 100
