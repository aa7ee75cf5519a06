"""The examples of the guide run, print what it says, and make their pictures."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
GUIDE = (ROOT / "docs/guide/python-examples.md").read_text()
PRINTED = dict(re.findall(r"/(\w+)\.py\):.*?\*(.+?)\*", GUIDE))


def test_the_guide_shows_every_example():
    scripts = {path.stem for path in (ROOT / "bindings/python/examples").glob("*.py")}
    assert set(PRINTED) == scripts - {"picture", "bake_visibility"}


@pytest.mark.parametrize("name", PRINTED)
def test_an_example_prints_and_draws_what_the_guide_shows(name, tmp_path):
    script, picture = ROOT / f"bindings/python/examples/{name}.py", tmp_path / "picture.png"
    result = subprocess.run([sys.executable, "-W", "error", script, picture], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == PRINTED[name]
    size = slice(16, 24)  # of the PNG's header: width and height
    assert picture.read_bytes()[size] == (ROOT / f"docs/images/python/{name}.png").read_bytes()[size]
