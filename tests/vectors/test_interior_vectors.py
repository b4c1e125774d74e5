"""The published vectors of interior mapping: true to the formula, reproducible, and able to tell a faulty one."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from pcc_addon.core.backends.arrays import evaluate
from tests.conformance.interior import expression
from tests.conformance.reference import angle

from . import make_interior

RUNNER = Path(__file__).with_name("interior_runner.py")
VECTORS = json.loads(make_interior.FILE.read_text(encoding="utf-8"))


def column(name: str) -> np.ndarray:
    return np.array([case[name] for case in VECTORS["cases"]])


def run(script: str, folder: Path) -> subprocess.CompletedProcess:
    (folder / "interior.json").write_bytes(make_interior.FILE.read_bytes())
    (folder / "runner.py").write_text(script, encoding="utf-8")
    return subprocess.run([sys.executable, "-I", folder / "runner.py"], capture_output=True, text=True)


def test_the_file_is_what_its_script_makes() -> None:
    found = make_interior.FILE.read_text(encoding="utf-8")
    assert found == make_interior.text(), "run: python3 dev.py run tests/vectors/make_interior.py"


def test_the_formula_passes_in_single_precision() -> None:
    place = np.concatenate([column("place"), np.zeros((len(VECTORS["cases"]), 1))], 1)
    inputs = {
        "Coordinates": place,
        "Ray": column("ray"),
        "Size": column("size"),
        **{f"Half Edge {axis}": column("half_edges")[:, k] for k, axis in enumerate("XYZ")},
        "Capture": column("capture"),
        "Quarters": column("quarters"),
        "Mirror": column("mirror"),
        "Offset": np.zeros(3),
    }
    for name in ("place", "ray", "size", "half_edges", "capture"):
        np.testing.assert_array_equal(column(name), column(name).astype(np.float32))
    found = evaluate({"Direction": expression()}, inputs, np.float32)["Direction"]
    assert (angle(found, column("direction")) <= column("tolerance")).all()


def test_the_example_runner_passes(tmp_path) -> None:
    result = run(RUNNER.read_text(encoding="utf-8"), tmp_path)
    assert result.returncode == 0 and "cases and 24 keys, 0 wrong" in result.stdout, result.stdout + result.stderr


def test_the_runner_tells_a_faulty_implementation(tmp_path) -> None:
    script = RUNNER.read_text(encoding="utf-8")
    faults = {
        "math.floor(c)": "int(c)",
        "max(1.0 - math.copysign(o, o * v), 1e-8)": "(1.0 - math.copysign(o, o * v) or math.inf)",
        "- p * near": "",
        "x, y = -y, x": "x, y = y, -x",
        'x *= case["mirror"]': "pass",
        "rotated(b, 24)": "rotated(b, 23)",
    }
    for right, wrong in faults.items():
        assert right in script
        assert run(script.replace(right, wrong), tmp_path).returncode == 1, wrong
