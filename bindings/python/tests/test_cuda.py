"""`kerf_bvh.cuda` without a device: what is said of arrays, of streams, and of the device that is not there."""

import ctypes
import gc
import subprocess
import sys
import weakref

import numpy as np
import pytest
import support

import kerf_bvh
from kerf_bvh import _kerf

IS_BUILT = hasattr(_kerf, "CudaBvh")
if IS_BUILT:
    import kerf_bvh.cuda as on_device

needs_cuda = pytest.mark.skipif(not IS_BUILT, reason="built without KERF_BINDINGS_CUDA")


def has_device():
    try:
        on_device.Hits.empty(1)
    except on_device.Error:
        return False
    return True


class Interface:
    """An array as CuPy and Numba describe theirs; nothing is read at its address."""

    def __init__(self, shape, typestr="<f4", address=0x1000, read_only=False, **entries):
        interface = {"shape": shape, "typestr": typestr, "data": (address, read_only), "version": 3}
        self.__cuda_array_interface__ = interface | entries


class Tensor:
    """An array of the host that says through DLPack that it lies on a device."""

    def __init__(self, array, device=(2, 0), version=None, refuse=None):
        self.array, self.device, self.version, self.refuse = array, device, version, refuse
        self.asked = []

    def __dlpack_device__(self):
        return self.device

    def __dlpack__(self, **arguments):
        self.asked.append(arguments)
        if self.refuse is not None:
            raise self.refuse
        if self.version is None and "max_version" in arguments:
            raise TypeError("__dlpack__() got an unexpected keyword argument 'max_version'")
        capsule = self.array.__dlpack__(**({} if self.version is None else {"max_version": (1, 0)}))
        tensor = address_in(capsule, self.version is not None)
        ctypes.c_int32.from_address(tensor + 8).value, ctypes.c_int32.from_address(tensor + 12).value = self.device
        if self.version is not None:
            ctypes.c_uint32.from_address(tensor - 32).value = self.version
        return capsule


def address_in(capsule, is_versioned):
    """Where a capsule has its tensor: behind version, manager, deleter and flags, if it has these."""
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return get(capsule, b"dltensor_versioned") + 32 if is_versioned else get(capsule, b"dltensor")


def rows(count=5):
    return np.zeros((count, 8), np.float32)


@pytest.fixture
def nothing():
    return on_device.Bvh()


@pytest.mark.skipif(IS_BUILT, reason="built with KERF_BINDINGS_CUDA")
def test_without_cuda_one_line_says_how_to_get_it():
    with pytest.raises(ImportError, match="KERF_BINDINGS_CUDA=ON$") as caught:
        import kerf_bvh.cuda  # noqa: F401
    assert "\n" not in str(caught.value)


@needs_cuda
def test_the_package_itself_does_not_load_it():
    command = "import kerf_bvh, sys; sys.exit('kerf_bvh.cuda' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", command]).returncode == 0


@needs_cuda
def test_a_hierarchy_of_nothing_needs_no_device(nothing):
    assert nothing.bounds is None and nothing.statistics.triangles == 0 and not nothing.origin.any()
    assert repr(nothing) == "<kerf_bvh.cuda.Bvh of 0 triangles, 0 bytes, device 0>"
    empty = Tensor(rows(0))
    assert len(nothing.occluded(empty, out=Tensor(np.zeros(0, np.uint8))).array) == 0
    nothing.refit_meshes([])


@needs_cuda
@pytest.mark.parametrize(
    ("array", "what"),
    [
        (Interface((5, 7)), "its shape is (5, 7), not (n, 8)"),
        (Interface((5,)), "its shape is (5), not (n, 8)"),
        (Interface((5, 8), "<f8"), "it does not hold floats of 32 bits"),
        (
            Interface((5, 8), ">f4"),
            'its type is neither an integer nor a float in the device\'s order of bytes (">f4")',
        ),
        (Interface((5, 8), strides=(64, 4)), "its elements do not follow one another without gaps"),
        (Interface((5, 8), strides=(4, 20)), "its elements do not follow one another without gaps"),
        (Interface((5, 8), address=0x1002), "its address is not a multiple of 4"),
        (Interface((5, 8), address=0), "it has no address"),
        (Interface((5, 8), mask=Interface((5, 8))), "it has a mask"),
        (Interface((5, 8), stream=0), "its stream is 0, which may be any of two"),
        (Interface((5, "x")), "its __cuda_array_interface__ has an entry of another type"),
        (Interface((5, 8), strides=3), "its __cuda_array_interface__ cannot be read ('int' object is not iterable)"),
        (Tensor(rows()[:, :7]), "its shape is (5, 7), not (n, 8)"),
        (Tensor(rows()[::2]), "its elements do not follow one another without gaps"),
        (Tensor(rows().astype(np.float64)), "it does not hold floats of 32 bits"),
        (Tensor(rows(), version=1, device=(2, 3)), "it lies on device 3, the hierarchy on device 0"),
        (Tensor(rows(), version=2), "it is of version 2 of DLPack, not 1"),
        (Tensor(rows(), device=(10, 0)), "it does not lie on a CUDA device (DLPack's device type 10)"),
        (Tensor(rows(), refuse=BufferError("it needs a gradient\nreally")), "it cannot be taken (it needs a gradient)"),
        (rows(), "it does not lie on a CUDA device (DLPack's device type 1)"),
    ],
)
def test_what_is_wrong_with_an_array_is_one_line(nothing, array, what):
    for call in (nothing.intersect, nothing.occluded, nothing.count_hits, nothing.all_hits):
        with pytest.raises(ValueError) as caught:
            call(array)
        assert str(caught.value) == "rays: " + what


@needs_cuda
def test_each_array_is_named(nothing):
    wrong, good, points = Interface((5, 9)), Tensor(rows()), Tensor(np.zeros((5, 3), np.float32))
    three = Interface((5, 3))
    for call, what in (
        (lambda: nothing.intersect(good, out=wrong), "out: its shape is (5, 9), not (n, 5)"),
        (lambda: nothing.intersect(good, out=Tensor(np.zeros((4, 5), np.int32))), "out: it has 4 rows, not 5"),
        (lambda: nothing.occluded(good, out=Interface((5,), "|b1", read_only=True)), "out: it can only be read"),
        (lambda: nothing.count_hits(good, out=Interface((5,), "<u8")), "out: it does not hold integers of 32 bits"),
        (lambda: nothing.contains(wrong), "points: its shape is (5, 9), not (n, 3)"),
        (lambda: nothing.signed_distance(points, out=wrong), "out: its shape is (5, 9), not (n)"),
        (lambda: nothing.closest_point(points, out=wrong), "out: its shape is (5, 9), not (n, 8)"),
        (lambda: nothing.list_hits(good, offsets=wrong, out=Interface((9, 5))),
         "offsets: it does not hold integers of 64 bits"),
        (lambda: nothing.list_hits(good, offsets=Tensor(np.zeros(3, np.int64)), out=Interface((9, 5))),
         "offsets: there are 3 of them, not one more than the 5 rays"),
        (lambda: nothing.intersect(wrong, points), "origins: its shape is (5, 9), not (n, 3)"),
        (lambda: nothing.intersect(points, wrong), "directions: its shape is (5, 9), not (n, 3)"),
        (lambda: nothing.intersect(points, [0, 0, 1], wrong), "t_min: its shape is (5, 9), not (n)"),
        (lambda: nothing.intersect(points, [0, 0, 1], 0, Tensor(np.zeros(4, np.float32))),
         "t_max: there are 4 of them for 5 rays"),
        (lambda: nothing.intersect(points, [0, 1]),
         "directions: shape (2,) on the host, where (3,) or an array of a device is needed"),
        (lambda: nothing.intersect([0, 0, 0], [0, 0, 1]),
         "origins and directions: neither of them is an array of a device"),
        (lambda: nothing.intersect(good, t_max=2.0), "t_min, t_max: given beside rays, whose rows hold them"),
        (lambda: on_device.rays(points, points, out=wrong), "out: its shape is (5, 9), not (n, 8)"),
        (lambda: on_device.Bvh.build(wrong, three), "vertices: its shape is (5, 9), not (n, 3)"),
        (lambda: on_device.Bvh.build(points, Interface((5, 3), "<i8")), "faces: it does not hold integers of 32 bits"),
        (lambda: on_device.Bvh.from_meshes([(points, Tensor(np.zeros((1, 3), np.int32))), (wrong, three)]),
         "mesh 1: vertices: its shape is (5, 9), not (n, 3)"),
        (lambda: nothing.refit(points, wrong), "faces: it does not hold integers of 32 bits"),
        (lambda: on_device.Bvh.build(points, points, max_reference_ratio=17), "max_reference_ratio must be in [1, 16]"),
        (lambda: on_device.Bvh.build(points, points, max_leaf_size=9), "max_leaf_size must be in [1, 8]"),
        (lambda: on_device.build_bytes(9, radius=65), "radius must be in [1, 64]"),
        (lambda: on_device.build_bytes(-1), "triangles: -1, where a number from 0 is needed"),
    ):  # fmt: skip
        with pytest.raises(ValueError) as caught:
            call()
        assert str(caught.value) == what


@needs_cuda
def test_a_frame_of_its_own_has_to_be_asked_for():
    placed = kerf_bvh.Bvh(support.CUBE_VERTICES.astype(np.float64) + np.pi, support.CUBE_FACES)
    assert placed.origin.any()
    with pytest.raises(ValueError, match="^bvh: built of float64 vertices, in a frame at .* local=True and give"):
        on_device.Bvh(placed)
    if has_device():
        assert (on_device.Bvh(placed, local=True).origin == placed.origin).all()
    else:
        with pytest.raises(on_device.Error):
            on_device.Bvh(placed, local=True)


@needs_cuda
def test_what_is_no_array_is_a_type_error(nothing):
    for call, what in (
        (lambda: nothing.intersect([[0.0] * 8]), "rays: list has neither __dlpack__ nor __cuda_array_interface__"),
        (lambda: nothing.intersect((rows(), rows())),
         "rays: a tuple, where an array of a device is needed; its parts are arguments"),
        (lambda: nothing.intersect(None), "rays: NoneType has neither __dlpack__ nor __cuda_array_interface__"),
        (lambda: on_device.Bvh(support.CUBE_VERTICES),
         "bvh: ndarray, where a kerf_bvh.Bvh is needed; Bvh.build takes arrays"),
        (lambda: on_device.Bvh.from_meshes(3), "meshes: a list of tuples of vertices and faces is needed"),
        (lambda: nothing.intersect(Tensor(rows()), stream="x"),
         "stream: str is no stream of CUDA, and has no __cuda_stream__"),
    ):  # fmt: skip
        with pytest.raises(TypeError) as caught:
            call()
        assert str(caught.value) == what


@needs_cuda
def test_libraries_are_told_the_stream_and_the_version(nothing):
    def streams_of(library, **arguments):
        with pytest.raises((ValueError, on_device.Error)):
            nothing.intersect(library, **arguments)
        return [(asked["stream"], "max_version" in asked) for asked in library.asked]

    assert streams_of(Tensor(rows(), version=1)) == [(1, True)]
    assert streams_of(Tensor(rows(), version=1), stream=1) == [(1, True)]
    assert streams_of(Tensor(rows()), stream=2) == [(2, True), (2, False)]  # one that knows no versions
    assert streams_of(Tensor(rows()[:, :7], version=1), stream=0x1230) == [(0x1230, True)]


@needs_cuda
def test_streams_of_every_library_are_read():
    class Handle:
        def __init__(self, **attributes):
            vars(self).update(attributes)

    number = on_device.stream_number
    assert number(None) == number(0) == number(1) == number(Handle(ptr=0)) == 0
    assert number(2) == 2
    assert number(Handle(__cuda_stream__=lambda: (0, 77), ptr=3)) == 77
    assert number(Handle(__cuda_stream__=(0, 77))) == 77
    assert number(Handle(cuda_stream=78)) == 78
    assert number(Handle(ptr=79)) == 79
    assert number(Handle(handle=ctypes.c_void_p(80))) == 80
    assert number(Handle(handle=ctypes.c_void_p(None))) == 0
    for wrong in (True, "1", 1.0, Handle()):
        with pytest.raises(TypeError, match="^stream: "):
            number(wrong)
    with pytest.raises(ValueError, match="^stream: -1 is no stream$"):
        number(-1)


@needs_cuda
def test_arrays_are_given_back(nothing):
    for version in (None, 1):
        array = rows()
        tensor, gone = Tensor(array[:, :7], version=version), weakref.ref(array)
        with pytest.raises(ValueError):
            nothing.intersect(tensor)
        del array, tensor
        gc.collect()
        assert gone() is None


@needs_cuda
def test_arrays_of_kerf_describe_themselves():
    hits = on_device.Hits.empty(0)
    assert len(hits) == 0 and hits.rows.shape == (0, 5) and hits.t.strides == (20,) and hits.t.dtype == np.float32
    assert hits.primitive.dtype == np.uint32 and repr(hits.t).startswith(
        "<kerf_bvh.cuda.DeviceArray of float32, shape (0,)"
    )
    points = on_device.SurfacePoints.empty(0)
    assert points.position.shape == (0, 3) and points.position.strides == (32, 4)
    assert hits.rows.__cuda_array_interface__ == {
        "shape": (0, 5), "typestr": "<f4", "data": (0, False), "strides": (20, 4), "stream": None, "version": 3
    }  # fmt: skip
    assert hits.mesh.__cuda_array_interface__["typestr"] == "<u4"
    assert hits.t.__dlpack_device__() == (2, 0)
    assert '"dltensor"' in repr(hits.t.__dlpack__()) and '"dltensor"' in repr(
        hits.t.__dlpack__(stream=1, max_version=(0, 8))
    )
    capsule = points.position.__dlpack__(stream=-1, max_version=(1, 1))
    tensor = address_in(capsule, True)
    assert ctypes.c_int32.from_address(tensor + 8).value == 2 and ctypes.c_int32.from_address(tensor + 16).value == 2
    assert [ctypes.c_uint8.from_address(tensor + at).value for at in (20, 21, 22)] == [2, 32, 1]  # a float of 32 bits
    shape, strides = (ctypes.c_void_p.from_address(tensor + at).value for at in (24, 32))
    assert [ctypes.c_int64.from_address(shape + at).value for at in (0, 8)] == [0, 3]
    assert [ctypes.c_int64.from_address(strides + at).value for at in (0, 8)] == [8, 1]
    with pytest.raises(ValueError, match="^stream: 0 may be any of two; the default stream is 1$"):
        hits.t.__dlpack__(stream=0)
    for arguments in ({"copy": True}, {"dl_device": (1, 0)}):
        with pytest.raises(BufferError, match=r"get\(\) copies it to the host"):
            hits.t.__dlpack__(**arguments)
    assert len(hits.get()) == 0 and hits.get().t.dtype == np.float32 and len(points.get().position) == 0


@needs_cuda
def test_the_bound_of_memory_is_the_librarys():
    assert on_device.build_bytes(1000) < on_device.build_bytes(1000, max_reference_ratio=4) < 100_000_000


@needs_cuda
@pytest.mark.skipif(IS_BUILT and has_device(), reason="there is a device")
def test_without_a_device_an_error_gives_cudas_reason(nothing, cube):
    for call in (
        lambda: on_device.Bvh(cube),
        lambda: on_device.Bvh(cube, device=1),
        lambda: on_device.Hits.empty(4),
        lambda: nothing.intersect(Tensor(rows())),
        lambda: nothing.intersect(Interface((5, 8))),
        lambda: nothing.intersect(Interface((5, 8), stream=1), stream=2),
        lambda: nothing.occluded(Tensor(rows()), out=Tensor(np.zeros(5, np.bool_))),
        lambda: nothing.intersect(Tensor(np.zeros((5, 3), np.float32)), [0, 0, 1]),
        lambda: on_device.Bvh.build(Tensor(support.CUBE_VERTICES), Tensor(support.CUBE_FACES)),
    ):
        with pytest.raises(on_device.Error, match="^CUDA: while [^\n]*: [^\n]+$"):
            call()
    assert issubclass(on_device.Error, RuntimeError)
