"""The published vectors: true to the formulas, reproducible, and able to tell a faulty implementation."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate

from . import lookup, refracted
from .make import FILES
from .ours import Check, checks
from .vector_file import VectorFile, columns

HERE = Path(__file__).parent
EACH = pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)

FAULTS = {
    "example_runner.py": {
        "max(half - math.copysign(q, q * speed), 1e-12)": "(half - math.copysign(q, q * speed) or math.inf)",
        "math.copysign(q, q * speed)": "abs(q)",
        "-1.0)), nearness), ray)": "-1.0)), 0.0), ray)",
        "return plus(scaled(plus(start": "return [0.0, 0.0, 0.0] or plus(scaled(plus(start",
        "dot(face, exit) / half": "dot(face, exit)",
        'case["centre"]})': 'case["capture_point"]})',
        'beyond - case["padding"]': 'beyond + case["padding"]',
        "1.0 / math.sqrt(": "1.0 / (",
        "0.35), 1.5)": "0.5), 1.5)",
    },
    "refracted_runner.py": {
        '1.0 / index if case["backfacing"] else index': "index",
        "1.0 - cosine * cosine": "1.0 - cosine",
        "rest > 0.0": "True",
        "return direction if passes else mirrored": "return direction",
        "scaled(leaving, -2.0": "scaled(leaving, -1.0",
        'plus(case["position"], offset)': 'case["position"]',
        "1.0 / index)\n    mirrored": "index)\n    mirrored",
        "w) / h for": "w) for",
        "near = unit([h * dot": "near = unit([dot",
        "direction if passes else straight": "direction",
    },
    "shares_runner.py": {
        "min(outside[j]": "max(outside[j]",
        "0.2 * fade": "0.3 * fade",
        "min(before / (0.2 * fade), 1.0)": "1.0",
        "min(weight, inside": "(inside",
        "part * (1.0 - share)": "part",
        '1.0 - case["diffuse"]': "1.0",
        "coverage * (1.0 - covers)": "coverage",
        " or 1.0)": " + 1e-9)",
        "* handed_over * weight": "* handed_over",
    },
    "levels_runner.py": {
        ' * case["spread"]': "",
        ", rungs[0]),": ", 0.0),",
        "rungs[0]), rungs[-1])": "rungs[0]), 2.0)",
        "1.0 - share": "share",
        "/ (rungs[k] - rungs[k - 1])": "/ rungs[-1]",
    },
    "dominant_runner.py": {
        "return plus(mirrored, unit": "return unit(",
        "hidden(z, alpha)": "0.0",
        'fresnel(on_facet, case["ior"])': "1.0",
        "** 2\n    mirrored": "\n    mirrored",
    },
    "interior_runner.py": {
        "math.floor(c)": "int(c)",
        "max(1.0 - math.copysign(o, o * v), 1e-8)": "(1.0 - math.copysign(o, o * v) or math.inf)",
        "- p * nearness": "",
        "x, y = -y, x": "x, y = y, -x",
        'x *= case["mirror"]': "pass",
        "rotated(b, 24)": "rotated(b, 23)",
    },
}


@EACH
def test_the_file_is_what_its_script_makes(file: VectorFile) -> None:
    assert file.path.read_text(encoding="utf-8") == file.text(), "run: python3 dev.py run tests/vectors/make.py"


@EACH
def test_inputs_are_float32_numbers(file: VectorFile) -> None:
    for record in file.read():
        for name in file.inputs:
            values = np.array(record[name])
            np.testing.assert_array_equal(values, values.astype(np.float32))


@pytest.mark.parametrize("check", checks(), ids=str)
def test_our_formulas_pass_in_single_precision(check: Check) -> None:
    met = check.met(evaluate(check.formula.outputs, check.inputs, np.float32))
    assert met.all() and len(met) >= 10, np.flatnonzero(~met)


def test_there_are_cases_inside_outside_and_in_the_fade() -> None:
    cases = columns(lookup.FILE.read())
    weight, sure = cases["weight"], cases["weight_tolerance"] < 1e-3
    assert min(((weight == 1.0) & sure).sum(), ((weight == 0.0) & sure).sum()) > 20
    assert ((weight > 0.01) & (weight < 0.99) & sure).sum() > 20


def test_light_passes_and_does_not_whichever_way_it_is_bent() -> None:
    cases = refracted.FILE.read()
    for interface in ("one interface", "solid"):
        passes = [case["passes"] for case in cases if case["interface"] == interface]
        assert min(passes.count(True), passes.count(False)) > 15


def run(runner: str, script: str, folder: Path) -> subprocess.CompletedProcess:
    """A runner beside the vectors and what runners share, without anything but the standard library."""
    for path in (*HERE.glob("*.json"), HERE / "checking.py", HERE / "example_runner.py"):
        if not (folder / path.name).exists():
            (folder / path.name).symlink_to(path)
    (folder / f"tried_{runner}").write_text(script, encoding="utf-8")
    return subprocess.run([sys.executable, "-E", "-s", folder / f"tried_{runner}"], capture_output=True, text=True)


@pytest.mark.parametrize("runner", FAULTS)
def test_the_runners_pass_are_short_and_tell_a_faulty_implementation(runner: str, tmp_path: Path) -> None:
    script = (HERE / runner).read_text(encoding="utf-8")
    result = run(runner, script, tmp_path)
    assert result.returncode == 0 and " 0 wrong" in result.stdout, result.stdout + result.stderr
    assert len(script.splitlines()) <= 65
    for right, wrong in FAULTS[runner].items():
        assert right in script, right
        result = run(runner, script.replace(right, wrong), tmp_path)
        assert result.returncode == 1 and " wrong" in result.stdout and " 0 wrong" not in result.stdout, (
            wrong,
            result.stdout + result.stderr,
        )
