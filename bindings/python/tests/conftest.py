import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import support  # noqa: E402

import kerf_bvh  # noqa: E402


@pytest.fixture(scope="session")
def cube():
    return kerf_bvh.Bvh(support.CUBE_VERTICES, support.CUBE_FACES)


@pytest.fixture(scope="session")
def ball():
    return kerf_bvh.Bvh(*support.sphere())


@pytest.fixture
def random():
    import numpy

    return numpy.random.default_rng(7)
