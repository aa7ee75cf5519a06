"""Answers of a device: bit for bit those of the CPU, with arrays of CuPy, PyTorch, JAX and Numba, where they lie.

Skipped, saying so, where there is no device, and for each library that is not there. It needs no pytest.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import threading
import unittest
from pathlib import Path

import numpy as np

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
sys.path.insert(0, str(Path(__file__).parent))

import support  # noqa: E402

import kerf_bvh  # noqa: E402

try:
    import kerf_bvh.cuda as on_device
except ImportError as error:
    raise unittest.SkipTest(f"NO CUDA IN THIS BUILD, nothing is tested here: {error}") from None


def setUpModule():
    try:
        on_device.Hits.empty(1)
    except on_device.Error as error:
        raise unittest.SkipTest(f"NO CUDA DEVICE, nothing is tested here: {error}") from None


# ---- a scene, and what the CPU answers


def meshes():
    vertices, faces = support.sphere(40, 60)
    ball = (vertices.astype(np.float32), faces.astype(np.uint32))
    box = (support.CUBE_VERTICES * np.float32(40) - np.float32(20), support.CUBE_FACES)  # large triangles, to be split
    inner = (ball[0] * np.float32(0.4) + np.float32(0.25), ball[1])
    return [ball, box, inner]


def moved(parts):
    return [(v + np.float32(0.1) * np.sin(3 * v[:, [1, 2, 0]]).astype(np.float32), f) for v, f in parts]


def questions(count=5000, seed=1):
    random = np.random.default_rng(seed)
    rows = np.empty((count, 8), np.float32)
    rows[:, 0:3] = random.normal(size=(count, 3)) * 2
    rows[:, 3:6] = random.normal(size=(count, 3))
    rows[:, 6] = random.uniform(-0.5, 0.5, count)
    rows[:, 7] = np.where(random.uniform(size=count) < 0.3, random.uniform(0, 4, count), np.inf)
    rows[0] = [50, 50, 50, 1, 0, 0, 0, np.inf]  # a miss
    return rows, (random.normal(size=(count, 3)) * 1.5).astype(np.float32)


def parts_of(rows):
    return tuple(np.ascontiguousarray(part) for part in (rows[:, 0:3], rows[:, 3:6], rows[:, 6], rows[:, 7]))


def bits(array):
    array = np.ascontiguousarray(array)
    return array if array.dtype == np.bool_ else array.view(f"u{array.itemsize}")


class Same(unittest.TestCase):
    def assertSame(self, given, expected, what=""):
        given, expected = np.asarray(given), np.asarray(expected)
        self.assertEqual(given.shape, expected.shape, what)
        different = int((bits(given) != bits(expected)).sum())
        self.assertEqual(different, 0, f"{what}: {different} of {expected.size} numbers differ")

    def assertSameRecords(self, given, expected, what=""):
        for name in vars(expected):
            self.assertSame(getattr(given, name), getattr(expected, name), f"{what}: {name}")


# ---- libraries


class CuPy:
    def __init__(self):
        self.cupy = importlib.import_module("cupy")

    def stream(self):
        return self.cupy.cuda.Stream(non_blocking=True)

    def working_on(self, stream):
        return stream

    def array(self, host):
        return self.cupy.asarray(host)

    def empty(self, shape, dtype):
        return self.cupy.empty(shape, dtype)

    def take(self, array):
        return self.cupy.asarray(array)

    def host(self, array):
        return self.cupy.asnumpy(array)

    def address(self, array):
        return array.data.ptr

    def fill(self, array, host):
        array.set(host)

    def copy(self, to, source):
        self.cupy.copyto(to, source)

    def wait(self):
        self.cupy.cuda.get_current_stream().synchronize()

    @contextlib.contextmanager
    def capture(self, stream, replays):
        with stream:
            stream.begin_capture()
            yield
            graph = stream.end_capture()
        replays.append(lambda: graph.launch(stream))


class PyTorch:
    def __init__(self):
        self.torch = importlib.import_module("torch")
        if not self.torch.cuda.is_available():
            raise ImportError("it finds no device")

    def stream(self):
        return self.torch.cuda.Stream()

    def working_on(self, stream):
        return self.torch.cuda.stream(stream)

    def array(self, host):
        host = host.view(np.int32) if host.dtype == np.uint32 else host
        return self.torch.from_numpy(np.ascontiguousarray(host)).to("cuda")

    def empty(self, shape, dtype):
        names = {"f": "float32", "u": "int32", "i": "int64", "b": "bool"}
        return self.torch.empty(shape, dtype=getattr(self.torch, names[np.dtype(dtype).kind]), device="cuda")

    def take(self, array):
        return self.torch.from_dlpack(array)

    def host(self, array):
        if array.dtype == self.torch.uint32:
            return array.view(self.torch.int32).cpu().numpy().view(np.uint32)
        return array.cpu().numpy()

    def address(self, array):
        return array.data_ptr()

    def fill(self, array, host):
        array.copy_(self.torch.from_numpy(host))

    def copy(self, to, source):
        to.copy_(source)

    def wait(self):
        self.torch.cuda.current_stream().synchronize()

    @contextlib.contextmanager
    def capture(self, stream, replays):
        graph = self.torch.cuda.CUDAGraph()
        with self.torch.cuda.graph(graph, stream=stream):
            yield
        replays.append(graph.replay)


class OfALibrary:
    """What holds for each library, on a stream of its own that the default one does not wait for."""

    make = None

    @classmethod
    def setUpClass(cls):
        try:
            cls.library = cls.make()
        except ImportError as error:
            raise unittest.SkipTest(f"NO {cls.make.__name__}, nothing is tested with it: {error}") from None
        cls.host_bvh = kerf_bvh.Bvh.from_meshes(meshes())
        cls.rows, cls.points = questions()

    def setUp(self):
        self.stream = self.library.stream()
        self.context = self.library.working_on(self.stream)
        self.context.__enter__()
        self.addCleanup(self.context.__exit__, None, None, None)
        self.rays = self.library.array(self.rows)
        self.asked = self.library.array(self.points)

    def on_device(self, parts):
        return [(self.library.array(v), self.library.array(f)) for v, f in parts]

    def hierarchies(self):
        yield "a copy", on_device.Bvh(self.host_bvh)
        for ratio in (1.0, 1.5, 4.0):
            built = on_device.Bvh.from_meshes(self.on_device(meshes()), stream=self.stream, max_reference_ratio=ratio)
            yield f"built with a ratio of {ratio}", built

    def host(self, array):
        return self.library.host(self.library.take(array))

    def records(self, made, expected):
        """The parts of hits or points, each taken by the library."""
        return type(expected)(*(self.host(getattr(made, name)) for name in vars(expected)))

    def check_all(self, bvh, host_bvh, what):
        options = {"stream": self.stream}
        parts = parts_of(self.rows)
        expected = host_bvh.intersect(*parts)
        self.assertGreater(int(expected.hit.sum()), 1000, what)
        self.assertSameRecords(self.records(bvh.intersect(self.rays, **options), expected), expected, what)
        self.assertSameRecords(bvh.intersect(self.rays, **options).get(), expected, what)
        self.assertSame(self.host(bvh.occluded(self.rays, **options)), host_bvh.occluded(*parts), what)
        self.assertSame(self.host(bvh.count_hits(self.rays, **options)), host_bvh.count_hits(*parts), what)
        lists, all_hits = bvh.all_hits(self.rays, **options), host_bvh.all_hits(*parts)
        self.assertSame(self.host(lists.offsets), all_hits.offsets, what)
        self.assertSameRecords(self.records(lists.items, all_hits.items), all_hits.items, what)
        self.assertSameRecords(lists.get()[7], all_hits[7], what)
        self.assertSame(self.host(bvh.contains(self.asked, **options)), host_bvh.contains(self.points), what)
        distances = host_bvh.signed_distance(self.points)
        self.assertSame(self.host(bvh.signed_distance(self.asked, **options)), distances, what)
        for limit in (np.inf, 0.2):
            closest = host_bvh.closest_point(self.points, limit)
            made = bvh.closest_point(self.asked, limit, **options)
            self.assertSameRecords(self.records(made, closest), closest, what)
            self.assertSameRecords(made.get(), closest, what)
        self.assertSame(bvh.bounds, host_bvh.bounds, what)
        self.assertEqual(bvh.statistics.triangles, host_bvh.statistics.triangles)

    def test_every_call_answers_as_the_cpu(self):
        for what, bvh in self.hierarchies():
            with self.subTest(what):
                self.check_all(bvh, self.host_bvh, what)

    def test_one_mesh_is_built_and_moved(self):
        before, after = meshes()[0], moved(meshes())[0]
        bvh = on_device.Bvh.build(*self.on_device([before])[0], stream=self.stream, max_leaf_size=4)
        self.assertEqual(bvh.statistics.triangles, len(before[1]))
        bvh.refit(*self.on_device([after])[0], stream=self.stream)
        hits, expected = bvh.intersect(self.rays, stream=self.stream), kerf_bvh.Bvh(*after).intersect(
            *parts_of(self.rows)
        )
        self.assertSameRecords(hits.get(), expected)

    def test_moved_hierarchies_answer_as_new_ones(self):
        after = moved(meshes())
        host_bvh, arrays = kerf_bvh.Bvh.from_meshes(after), self.on_device(after)
        for what, bvh in self.hierarchies():
            with self.subTest(what):
                bvh.refit_meshes(arrays, stream=self.stream)
                self.check_all(bvh, host_bvh, what + ", moved")

    def test_answers_go_where_the_caller_says(self):
        bvh, parts, count = on_device.Bvh(self.host_bvh), parts_of(self.rows), len(self.rows)
        options = {"stream": self.stream}
        hits = self.library.empty((count, 5), np.uint32)
        self.assertIs(bvh.intersect(self.rays, out=hits, **options), hits)
        own = on_device.Hits.empty(count)
        self.assertIs(bvh.intersect(self.rays, out=own, **options), own)
        expected = self.host_bvh.intersect(*parts)
        self.assertSameRecords(own.get(), expected)
        rows = np.ascontiguousarray(self.library.host(hits))
        self.assertSame(rows.view(np.float32)[:, 0], expected.t)
        self.assertSame(rows.view(np.uint32)[:, 3], expected.primitive)
        for call, dtype, answers in (
            ("occluded", np.bool_, self.host_bvh.occluded(*parts)),
            ("count_hits", np.uint32, self.host_bvh.count_hits(*parts)),
        ):
            out = self.library.empty((count,), dtype)
            self.assertIs(getattr(bvh, call)(self.rays, out=out, **options), out)
            self.assertSame(self.library.host(out).view(answers.dtype), answers, call)
        for call, dtype, answers in (
            ("contains", np.bool_, self.host_bvh.contains(self.points)),
            ("signed_distance", np.float32, self.host_bvh.signed_distance(self.points)),
        ):
            out = self.library.empty((count,), dtype)
            self.assertIs(getattr(bvh, call)(self.asked, out=out, **options), out)
            self.assertSame(self.library.host(out), answers, call)
        closest = on_device.SurfacePoints.empty(count)
        self.assertIs(bvh.closest_point(self.asked, out=closest, **options), closest)
        self.assertSameRecords(closest.get(), self.host_bvh.closest_point(self.points))
        out = self.library.empty((count, 8), np.float32)
        self.assertIs(bvh.closest_point(self.asked, out=out, **options), out)
        self.assertSame(self.library.host(out)[:, 3], self.host_bvh.closest_point(self.points).distance)

    def test_hits_are_listed_as_offsets_say(self):
        bvh, parts = on_device.Bvh(self.host_bvh), parts_of(self.rows)
        expected = self.host_bvh.all_hits(*parts)
        offsets = self.library.array(expected.offsets)
        out = on_device.Hits.empty(len(expected.items))
        self.assertIs(bvh.list_hits(self.rays, offsets=offsets, out=out, stream=self.stream), out)
        self.assertSameRecords(out.get(), expected.items)
        two = self.library.array(2 * np.arange(len(self.rows) + 1, dtype=np.int64))
        firsts = bvh.list_hits(self.rays, offsets=two, out=on_device.Hits.empty(2 * len(self.rows)), stream=self.stream)
        counts = np.diff(expected.offsets)
        self.assertSame(firsts.get().hit.reshape(-1, 2).sum(axis=1), np.minimum(counts, 2))

    def test_parts_of_rays_are_gathered(self):
        bvh, parts = on_device.Bvh(self.host_bvh), parts_of(self.rows)
        options = {"stream": self.stream}
        device_parts = [self.library.array(part) for part in parts]
        self.assertSame(self.host(on_device.rays(*device_parts, **options)), self.rows)
        out = self.library.empty(self.rows.shape, np.float32)
        self.assertIs(on_device.rays(*device_parts, out=out, **options), out)
        self.assertSame(self.library.host(out), self.rows)
        for call in ("occluded", "count_hits"):
            answers = self.host(getattr(bvh, call)(*device_parts, **options))
            self.assertSame(answers, getattr(self.host_bvh, call)(*parts), call)
        origins, directions, t_min, t_max = device_parts
        for given, host in (
            ((origins, [0, 0, -1]), (parts[0], [0, 0, -1])),
            (([0.1, 0.2, 0.3], directions), ([0.1, 0.2, 0.3], parts[1])),
            ((origins, directions, 0.125, t_max), (parts[0], parts[1], 0.125, parts[3])),
            ((origins, np.float32([0, 1, 0]), t_min, 2), (parts[0], np.float32([0, 1, 0]), parts[2], 2.0)),
        ):
            self.assertSameRecords(bvh.intersect(*given, **options).get(), self.host_bvh.intersect(*host))
        columns = self.rays[:, 0:3], self.rays[:, 3:6]  # rows with gaps
        self.assertSameRecords(bvh.intersect(*columns, **options).get(), self.host_bvh.intersect(parts[0], parts[1]))
        lists, expected = bvh.all_hits(*device_parts, **options).get(), self.host_bvh.all_hits(*parts)
        self.assertSame(lists.offsets, expected.offsets)
        self.assertSameRecords(lists.items, expected.items)

    def test_a_frame_of_its_own_is_that_of_the_cpu(self):
        vertices, faces = meshes()[0]
        placed = kerf_bvh.Bvh(vertices + np.float64(1000.1), faces)
        bvh = on_device.Bvh(placed, local=True)
        inside = self.host(bvh.contains(self.asked, stream=self.stream))
        self.assertSame(inside, placed.contains(self.points.astype(np.float64) + placed.origin))
        self.assertSame(bvh.bounds + placed.origin, placed.bounds)

    def test_nothing_is_copied_and_memory_lives_on(self):
        bvh = on_device.Bvh(self.host_bvh)
        hits = bvh.intersect(self.rays, stream=self.stream)
        for column in (hits.t, hits.primitive, hits.rows):
            taken = self.library.take(column)
            self.assertEqual(self.library.address(taken), column.__cuda_array_interface__["data"][0])
        t, expected = self.library.take(hits.t), self.host_bvh.intersect(*parts_of(self.rows)).t
        del hits, column, taken
        for _ in range(3):
            bvh.intersect(self.rays, stream=self.stream)  # would be given the same memory again
        self.assertSame(self.library.host(t), expected)
        empty = bvh.intersect(self.library.empty((0, 8), np.float32), stream=self.stream)
        self.assertEqual(self.library.take(empty.t).shape[0], 0)
        self.assertEqual(len(empty.get()), 0)

    def test_streams_wait_for_one_another(self):
        bvh, expected = on_device.Bvh(self.host_bvh), self.host_bvh.intersect(*parts_of(self.rows))
        size = 1 << 28
        one, other = self.library.empty((size,), np.bool_), self.library.empty((size,), np.bool_)
        late = self.library.empty(self.rows.shape, np.float32)
        late_points = self.library.empty(self.points.shape, np.float32)
        for stream in (None, self.library.stream(), self.stream):
            self.library.fill(late, np.zeros_like(self.rows))
            self.library.wait()
            for _ in range(60):  # some milliseconds, before rays are there
                self.library.copy(one, other)
            self.library.copy(late, self.rays)
            self.library.copy(late_points, self.asked)
            hits = bvh.intersect(late, stream=stream)  # on another stream than the copy
            inside = bvh.contains(late_points, stream=stream)
            taken, taken_inside = self.library.take(hits.t), self.library.take(inside)
            self.assertSame(self.library.host(taken), expected.t)
            self.assertSame(self.library.host(taken_inside), self.host_bvh.contains(self.points))
            self.assertSameRecords(hits.get(), expected)

    def test_calls_are_captured_into_a_graph(self):
        bvh, count = on_device.Bvh(self.host_bvh), len(self.rows)
        library, options = self.library, {"stream": self.stream}
        made = {
            "intersect": library.empty((count, 5), np.float32),
            "occluded": library.empty((count,), np.bool_),
            "count_hits": library.empty((count,), np.uint32),
            "contains": library.empty((count,), np.bool_),
            "signed_distance": library.empty((count,), np.float32),
        }
        own, firsts = on_device.Hits.empty(count), on_device.Hits.empty(count)
        closest, rows = on_device.SurfacePoints.empty(count), library.empty((count, 8), np.float32)
        each = library.array(np.arange(count + 1, dtype=np.int64))
        device_parts = [library.array(part) for part in parts_of(self.rows)]

        def ask():
            bvh.intersect(self.rays, out=made["intersect"], **options)
            bvh.occluded(self.rays, out=made["occluded"], **options)
            bvh.count_hits(self.rays, out=made["count_hits"], **options)
            bvh.contains(self.asked, out=made["contains"], **options)
            bvh.signed_distance(self.asked, out=made["signed_distance"], **options)
            bvh.closest_point(self.asked, out=closest, **options)
            on_device.rays(*device_parts, out=rows, **options)
            bvh.intersect(*device_parts, out=own, **options)
            bvh.list_hits(self.rays, offsets=each, out=firsts, **options)

        ask()  # kernels are loaded before the capture
        library.wait()
        replays = []
        with library.capture(self.stream, replays):
            ask()
        new_rows, new_points = questions(count, seed=2)
        library.fill(self.rays, new_rows)
        library.fill(self.asked, new_points)
        for array, part in zip(device_parts, parts_of(new_rows)):
            library.fill(array, part)
        library.wait()
        replays[0]()
        library.wait()
        parts = parts_of(new_rows)
        expected = self.host_bvh.intersect(*parts)
        self.assertSame(library.host(made["intersect"])[:, 0], expected.t)
        self.assertSame(library.host(made["occluded"]), self.host_bvh.occluded(*parts))
        self.assertSame(library.host(made["count_hits"]).view(np.uint32), self.host_bvh.count_hits(*parts))
        self.assertSame(library.host(made["contains"]), self.host_bvh.contains(new_points))
        self.assertSame(library.host(made["signed_distance"]), self.host_bvh.signed_distance(new_points))
        self.assertSameRecords(closest.get(), self.host_bvh.closest_point(new_points))
        self.assertSame(library.host(rows), new_rows)
        self.assertSameRecords(own.get(), expected)
        self.assertSameRecords(firsts.get(), expected)

    def test_threads_ask_at_once(self):
        bvh, expected = on_device.Bvh(self.host_bvh), self.host_bvh.intersect(*parts_of(self.rows))
        self.library.wait()
        failures = []

        def ask():
            try:
                stream = self.library.stream()
                with self.library.working_on(stream):
                    for _ in range(20):
                        hits = bvh.intersect(self.rays, stream=stream)
                    self.assertSameRecords(hits.get(), expected)
            except BaseException as failure:  # noqa: BLE001
                failures.append(failure)

        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])

    def test_what_is_wrong_is_told(self):
        bvh, array = on_device.Bvh(self.host_bvh), self.library.array
        for call, what in (
            (lambda: bvh.intersect(array(self.rows[:, :7].copy())), r"^rays: its shape is \(5000, 7\), not \(n, 8\)$"),
            (lambda: bvh.intersect(array(self.rows.astype(np.float64))), "^rays: it does not hold floats of 32 bits$"),
            (lambda: bvh.intersect(self.rows), "^rays: it does not lie on a CUDA device"),
            (lambda: bvh.intersect(self.rays[::2]), "^rays: its elements do not follow one another without gaps$"),
            (lambda: bvh.contains(self.asked, out=self.library.empty((4,), np.bool_)),
             "^out: it has 4 rows, not 5000$"),
            (lambda: bvh.intersect(self.rays[:5, 0:3], self.asked), "^directions: there are 5000 of them for 5 rays$"),
            (lambda: bvh.list_hits(self.rays, offsets=array(np.arange(3)), out=on_device.Hits.empty(2)),
             "^offsets: there are 3 of them, not one more than the 5000 rays$"),
        ):  # fmt: skip
            with self.assertRaisesRegex(ValueError, what):
                call()
        vertices, faces = self.on_device([meshes()[0]])[0]
        with self.assertRaisesRegex(on_device.Error, "a triangle names a vertex that its mesh has not"):
            on_device.Bvh.build(vertices[:9], faces, stream=self.stream)
        with self.assertRaisesRegex(on_device.Error, "the meshes are not those of the build"):
            bvh.refit(vertices, faces, stream=self.stream)
        t = bvh.intersect(self.rays).t
        with self.assertRaisesRegex(BufferError, r"^it lies on CUDA device \d; get\(\) copies it to the host$"):
            np.from_dlpack(t, device="cpu")
        for take in (np.from_dlpack, lambda array: self.host_bvh.contains(array)):  # without a word of what they want
            with self.assertRaises((BufferError, RuntimeError, ValueError)):
                take(t)


class WithCuPy(OfALibrary, Same):
    make = CuPy

    def test_the_interface_alone_is_taken(self):
        class Interface:
            def __init__(self, array):
                self.__cuda_array_interface__ = array.__cuda_array_interface__

        bvh, expected = on_device.Bvh(self.host_bvh), self.host_bvh.intersect(*parts_of(self.rows))
        self.assertSameRecords(bvh.intersect(Interface(self.rays), stream=self.stream).get(), expected)
        self.assertSameRecords(bvh.intersect(Interface(self.rays)).get(), expected)
        built = on_device.Bvh.from_meshes([tuple(Interface(a) for a in mesh) for mesh in self.on_device(meshes())])
        self.assertSameRecords(built.intersect(Interface(self.rays)).get(), expected)
        host = self.library.cupy.cuda.alloc_pinned_memory(64)
        pinned = {"shape": (2, 8), "typestr": "<f4", "data": (host.ptr, False), "version": 3}
        with self.assertRaisesRegex(ValueError, "^rays: there is no memory of a device at its address$"):
            bvh.intersect(type("Pinned", (), {"__cuda_array_interface__": pinned})())


class WithPyTorch(OfALibrary, Same):
    make = PyTorch

    def test_a_tensor_that_needs_a_gradient_is_refused(self):
        bvh = on_device.Bvh(self.host_bvh)
        with self.assertRaisesRegex(ValueError, "^rays: it cannot be taken "):
            bvh.intersect(self.rays.clone().requires_grad_())
        self.assertEqual(len(bvh.intersect(self.rays.clone().requires_grad_().detach())), len(self.rows))


class WithJax(Same):
    def test_arrays_are_taken_both_ways(self):
        try:
            jax = importlib.import_module("jax")
            device = jax.devices("gpu")[0]
        except (ImportError, RuntimeError) as error:
            self.skipTest(f"NO JAX ON A DEVICE, nothing is tested with it: {error}")
        host_bvh, (rows, points) = kerf_bvh.Bvh.from_meshes(meshes()), questions()
        bvh = on_device.Bvh(host_bvh)
        rays = jax.device_put(rows, device)
        hits, expected = bvh.intersect(rays), host_bvh.intersect(*parts_of(rows))
        self.assertSameRecords(hits.get(), expected)
        taken = np.asarray(jax.dlpack.from_dlpack(hits.rows))
        self.assertSame(taken[:, 0], expected.t)
        self.assertSame(np.ascontiguousarray(taken).view(np.uint32)[:, 3], expected.primitive)
        inside = np.asarray(jax.dlpack.from_dlpack(bvh.contains(jax.device_put(points, device))))
        self.assertSame(inside, host_bvh.contains(points))
        vertices, faces = meshes()[0]
        built = on_device.Bvh.build(jax.device_put(vertices, device), jax.device_put(faces, device))
        expected = kerf_bvh.Bvh(vertices, faces).intersect(*parts_of(rows))
        self.assertSameRecords(built.intersect(rays).get(), expected)


class WithNumba(Same):
    def test_arrays_are_taken_both_ways(self):
        try:
            cuda = importlib.import_module("numba.cuda")
            stream = cuda.stream()
        except Exception as error:  # noqa: BLE001: its own errors, where it finds no driver
            self.skipTest(f"NO NUMBA ON A DEVICE, nothing is tested with it: {error}")
        host_bvh, (rows, _) = kerf_bvh.Bvh.from_meshes(meshes()), questions()
        bvh, rays = on_device.Bvh(host_bvh), cuda.to_device(rows, stream=stream)
        expected = host_bvh.intersect(*parts_of(rows))
        hits = bvh.intersect(rays, stream=stream)
        self.assertSame(cuda.as_cuda_array(hits.rows).copy_to_host()[:, 0], expected.t)
        self.assertSameRecords(hits.get(), expected)
        out = cuda.device_array(len(rows), np.uint8)
        self.assertIs(bvh.occluded(rays, out=out, stream=stream), out)
        stream.synchronize()
        self.assertSame(out.copy_to_host().astype(bool), host_bvh.occluded(*parts_of(rows)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
