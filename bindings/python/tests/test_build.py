"""Builds: options, several meshes, progress, interruption, errors."""

import signal
import threading
import time

import numpy as np
import pytest
import support

import kerf_bvh


def many_triangles(count):
    rng = np.random.default_rng(3)
    corners = rng.random((count, 1, 3), np.float32) + 0.01 * rng.random((count, 3, 3), np.float32)
    return corners


def test_statistics_tell_what_was_built(cube):
    statistics = cube.statistics
    assert statistics.triangles == 12 and statistics.degenerate_triangles == 0
    assert statistics.references >= 12 and statistics.bytes > 0 and statistics.build_seconds > 0
    assert "12 triangles" in repr(cube)


def test_corners_alone_are_triangles():
    bvh = kerf_bvh.Bvh(support.CUBE_VERTICES[support.CUBE_FACES])
    assert bvh.contains([0.5, 0.5, 0.5]) and bvh.statistics.triangles == 12


def test_meshes_keep_their_numbers_and_masks():
    above = support.CUBE_VERTICES + np.float32([0, 0, 2])
    both = kerf_bvh.Bvh.from_meshes(
        [(support.CUBE_VERTICES, support.CUBE_FACES), above[support.CUBE_FACES]], masks=[1, 2]
    )
    down = ([0.25, 0.5, 9], [0, 0, -1])
    assert both.intersect(*down).mesh == 1
    assert both.intersect(*down, mask=1).mesh == 0
    assert not both.occluded(*down, mask=4)
    origins = np.tile(down[0], (3, 1))
    assert both.intersect(origins, down[1], mask=np.array([1, 2, 4])).mesh.tolist() == [0, 1, kerf_bvh.INVALID]
    assert [mesh.triangles for mesh in both.mesh_statistics] == [12, 12]
    assert both.mesh_statistics[1].bounds.tolist() == [[0, 0, 2], [1, 1, 3]]
    accept = [np.ones(12, bool), np.zeros(12, bool)]
    assert both.intersect(*down, accept=accept).mesh == 0


def test_the_same_hits_for_any_builder_and_number_of_threads(random):
    corners = many_triangles(2000)
    origins, directions = random.random((500, 3), np.float32), random.normal(size=(500, 3)).astype(np.float32)
    hits = [
        kerf_bvh.Bvh(corners, builder=builder, threads=threads).intersect(origins, directions, threads=threads)
        for builder in ("sbvh", "bvh", "esc", "evh")
        for threads in (0, 1, 2)
    ]
    for other in hits[1:]:
        assert np.array_equal(hits[0].t, other.t) and np.array_equal(hits[0].primitive, other.primitive)


def test_better_trees_cost_less_and_give_the_same_hits():
    rng = np.random.default_rng(5)
    corners = rng.random((3000, 1, 3)) + 0.05 * rng.random((3000, 3, 3))
    costs = {quality: kerf_bvh.measure(corners, quality=quality).sah for quality in ("fast", "high", "best")}
    assert costs["best"] < costs["high"] < costs["fast"]
    origins, directions = rng.random((500, 3)), rng.random((500, 3)) - 0.5
    fast = kerf_bvh.Bvh(corners).intersect(origins, directions)
    for options in (
        {"quality": "high"},
        {"quality": "best"},
        {"quality": "best", "max_refinement_seconds": 0.0},
        {"sample_rays": (origins, directions)},
        {"quality": "best", "sample_rays": (origins, directions.astype(np.float32), 2.0)},
    ):
        other = kerf_bvh.Bvh(corners, **options).intersect(origins, directions)
        assert np.array_equal(other.t, fast.t) and np.array_equal(other.primitive, fast.primitive)


def test_options_that_cannot_be_right_are_refused():
    for options, sentence in [
        ({"builder": "best"}, "there is no builder best, but there are bvh, sbvh, esc, evh"),
        ({"quality": "good"}, "quality must be"),
        ({"quality": "best", "max_refinement_seconds": -1.0}, "max_refinement_seconds"),
        ({"alpha": 2.0}, "alpha"),
        ({"max_leaf_size": 9}, "max_leaf_size"),
        ({"max_leaf_size": -1}, "max_leaf_size"),
        ({"max_reference_ratio": 0.5}, "max_reference_ratio"),
        ({"threads": -1}, "threads"),
        ({"sample_rays": np.zeros((4, 6))}, "sample_rays: a tuple of origins and directions"),
        ({"sample_rays": (np.zeros((4, 3)), np.zeros((5, 3)))}, "sample_rays: 4 origins for 5 directions"),
        ({"sample_rays": (np.zeros((4, 3)), np.zeros((4, 2)))}, "sample_rays: directions: shape"),
        ({"sample_rays": (np.zeros((4, 3)), np.zeros((4, 3)), np.zeros(3))}, "sample_rays: 3 t_max for 4 rays"),
    ]:
        with pytest.raises(ValueError, match=sentence):
            kerf_bvh.Bvh(support.CUBE_VERTICES, support.CUBE_FACES, **options)
    with pytest.raises(ValueError, match="masks: 1 of them for 2 meshes"):
        kerf_bvh.Bvh.from_meshes([support.CUBE_VERTICES[support.CUBE_FACES]] * 2, masks=[1])
    with pytest.raises(ValueError, match="masks: -1, where a set of 32 bits is needed"):
        kerf_bvh.Bvh.from_meshes([support.CUBE_VERTICES[support.CUBE_FACES]], masks=[-1])


def test_vertices_that_are_not_finite_are_refused_or_skipped():
    vertices = support.CUBE_VERTICES.copy()
    vertices[6] = np.nan
    for precision in ("f4", "f8"):
        with pytest.raises(ValueError, match="vertex 6 .*used by triangle 2, is .*nan"):
            kerf_bvh.Bvh(vertices.astype(precision), support.CUBE_FACES)
        bvh = kerf_bvh.Bvh(vertices.astype(precision), support.CUBE_FACES, skip_non_finite=True)
        assert bvh.statistics.non_finite_triangles == np.isin(support.CUBE_FACES, 6).any(axis=1).sum()


def test_measures_are_those_of_the_tree():
    # One leaf: the cost is its number of triangles, and nothing overlaps.
    leaf = kerf_bvh.measure(support.CUBE_VERTICES, support.CUBE_FACES[:1])
    assert (leaf.sah, leaf.epo, leaf.references, leaf.nodes, leaf.leaves, leaf.depth) == (1, 0, 1, 1, 1, 0)
    corners = many_triangles(3000)
    split, plain = kerf_bvh.measure(corners), kerf_bvh.measure(corners.astype(float), builder="bvh")
    assert plain.references == 3000 <= split.references and plain.nodes == 2 * plain.leaves - 1
    assert split.sah > 0 and split.epo > 0 and split.lcv > 0
    for dtype in (np.int32, np.int64, np.uint64):
        again = kerf_bvh.measure(support.CUBE_VERTICES.astype(float), support.CUBE_FACES[:1].astype(dtype))
        assert again == leaf
    with pytest.raises(ValueError, match="there is no builder best"):
        kerf_bvh.measure(corners, builder="best")


def test_a_memory_bound_is_told_and_kept():
    bvh = kerf_bvh.Bvh(many_triangles(5000))
    assert 0 < bvh.statistics.build_peak_bytes <= kerf_bvh.build_memory_bound(5000)


def test_progress_rises_on_the_calling_thread():
    seen = []
    kerf_bvh.Bvh(many_triangles(30000), progress=lambda f: seen.append((f, threading.get_ident())))
    fractions = [fraction for fraction, _ in seen]
    assert fractions == sorted(set(fractions)) and 0 <= fractions[0] and fractions[-1] <= 1
    assert {thread for _, thread in seen} == {threading.get_ident()}


def test_progress_cancels_a_build_and_its_exceptions_pass():
    with pytest.raises(kerf_bvh.Cancelled, match="cancelled"):
        kerf_bvh.Bvh(many_triangles(200000), progress=lambda fraction: False)

    def fail(fraction):
        raise KeyError(fraction)

    with pytest.raises(KeyError):
        kerf_bvh.Bvh(many_triangles(200000), progress=fail)


def interrupted(work):
    """Runs `work`, which Ctrl-C ends a moment after it has begun."""
    main = threading.main_thread().ident
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
    threading.Timer(0.1, signal.pthread_kill, [main, signal.SIGINT]).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_a_build():
    corners = many_triangles(300000)
    interrupted(lambda: [kerf_bvh.Bvh(corners, threads=1) for _ in range(100)])


def test_ctrl_c_ends_a_call_of_many_rays_midway():
    bvh = kerf_bvh.Bvh(many_triangles(2000))
    origins = np.broadcast_to(np.float32([0.5, 0.5, -1]), (1 << 26, 3))
    out = kerf_bvh.Hits.empty(1 << 26)
    out.primitive[-1] = 7
    interrupted(lambda: bvh.intersect(origins, [0, 0, 1], 0, 1e-3, threads=1, out=out))
    assert out.primitive[-1] == 7


def test_ctrl_c_ends_a_call_that_lists_midway():
    bvh = kerf_bvh.Bvh(many_triangles(20000))
    points = np.broadcast_to(np.float32([0.5, 0.5, 0.5]), (1 << 22, 3))  # half a minute and more
    began = time.monotonic()
    interrupted(lambda: bvh.within(points, 0.05, threads=1))
    assert time.monotonic() - began < 10


def turns_during(call):
    """How often this thread has its turn while another one makes the call."""
    begun, done = threading.Event(), threading.Event()

    def run():
        begun.set()
        call()
        done.set()

    thread = threading.Thread(target=run)
    thread.start()
    begun.wait()
    turns = 0
    while not done.is_set():
        turns += 1
        time.sleep(0.001)
    thread.join()
    return turns


def test_other_threads_run_while_one_builds_and_asks(random):
    corners = many_triangles(100000)
    bvh = kerf_bvh.Bvh(corners)
    origins = random.random((100000, 3), np.float32)
    directions = random.random((100000, 3), np.float32) - np.float32(0.5)
    # On a busy machine this thread may wait for longer than a call takes: one call of several has to show it.
    for call in (lambda: kerf_bvh.Bvh(corners), lambda: bvh.intersect(origins, directions)):
        assert any(turns_during(call) > 5 for _ in range(10))


def test_threads_may_ask_one_hierarchy_at_the_same_time(ball, random):
    points = random.normal(size=(2000, 3))
    expected = ball.signed_distance(points)
    answers = [None] * 4

    def ask(i):
        answers[i] = ball.signed_distance(points)

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(answer, expected) for answer in answers)
