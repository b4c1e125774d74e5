"""Printed formulas compile, and compute what NumPy computes: the published vectors, pictures and surfaces."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.backends.glsl import functions, identifier
from pcc_addon.core.effects import lookup
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.dominant import dominant
from pcc_addon.core.effects.fresnel import METAL, dielectric_facets
from pcc_addon.core.effects.interior import Cells, Interior, RoomPicture, interior
from pcc_addon.core.effects.metal import Metal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.effects.roughness import mixed_formula
from pcc_addon.core.effects.surface import SurfaceEffects, surface_formula
from pcc_addon.core.effects.thin_film import ThinFilm
from pcc_addon.core.expression import Expr, Formula, random, vector
from tests.conformance.subjects import SUBJECTS, Subject
from tests.core.boxes import directions
from tests.glsl.shaders import run, vertex_shader
from tests.vectors.ours import Check, checks

LOOKUPS = [LookupEffects(c, o) for c in Correction for o in (*Outside, None) if c is not Correction.NONE]
LOOKUPS += [LookupEffects(c, Outside.UNCORRECTED, False, stretched=True) for c in Correction]
LOOKUPS += [LookupEffects(Correction.ORIENTED_BOX, Outside.OWN, hardening=True)]
LOOKUPS += [LookupEffects(Correction.ORIENTED_BOX, o, hardening=True, steps=3, refinements=2) for o in (None, *Outside)]
FORMULAS = [
    lookup.probe(LookupEffects(Correction.NONE, None, False), {"Level 0": 32}),
    *(lookup.probe(effects, {"Level 0": 64, "Level 1": 32}, shares=True) for effects in LOOKUPS),
    mixed_formula((0.0, 0.1, 0.3)),
    mixed_formula((0.0, 0.1, 0.3), True),
    dominant((dielectric_facets(1.5), METAL)),
    interior(Interior((RoomPicture(), RoomPicture(capture=(0.1, 0.2, 0.3))), middle=True, curtains=True)),
    interior(Interior((RoomPicture(),), Cells.UV)),
    *(subject.formula for subject in SUBJECTS if subject.kind in {"seen through", "shares"}),
    surface_formula(SurfaceEffects((Multiscatter(), Dielectric.of(1.5, None), Metal(tinted=True)))),
    surface_formula(SurfaceEffects((Multiscatter(), ThinFilm(), Dielectric.of(1.5, None), Metal(tinted=True)))),
]


@pytest.mark.skipif(not shutil.which("glslangValidator"), reason="needs glslangValidator (Debian: glslang-tools)")
@pytest.mark.parametrize("version", ["330 core", "300 es"])
@pytest.mark.parametrize("formula", FORMULAS, ids=lambda f: f.title[:30])
def test_the_text_is_valid(tmp_path: Path, formula: Formula, version: str) -> None:
    precision = "precision highp float;\nprecision highp sampler2D;\n" if version.endswith("es") else ""
    path = tmp_path / "formula.vert"
    path.write_text(f"#version {version}\n{precision}{vertex_shader(formula)}")
    checked = subprocess.run(["glslangValidator", path], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout


def test_names_are_such_as_glsl_has() -> None:
    assert identifier("Größe der Box, µm") == "Gr_e_der_Box_m"
    assert identifier(" Axis X (unit)") == "Axis_X_unit"


def test_a_part_that_is_used_twice_is_computed_once() -> None:
    """Otherwise this takes 2⁴⁰ lines."""
    doubled: Expr = vector("a")
    for _ in range(40):
        doubled = doubled + doubled
    text = functions(Formula("Doubled", {"Result": doubled}))
    assert text.count("+") == 40


@pytest.fixture(scope="module")
def driver() -> None:
    """Something that runs shaders."""
    pytest.importorskip("moderngl", reason="needs moderngl")
    import moderngl

    try:
        moderngl.create_standalone_context(backend="egl").release()
    except Exception as error:  # the drivers of this machine decide which
        pytest.skip(f"no OpenGL here: {error}")


@pytest.mark.parametrize("check", checks(), ids=str)
def test_it_passes_the_published_vectors(driver: None, check: Check) -> None:
    met = check.met(run(check.formula, check.inputs))
    assert met.all(), np.flatnonzero(~met)


@pytest.mark.parametrize("subject", SUBJECTS, ids=str)
def test_it_stays_within_the_bound_on_the_families_of_hard_cases(driver: None, subject: Subject) -> None:
    cases, where = subject.together(256)
    verdict = subject.judge(cases, run(subject.formula, cases.inputs()))
    assert verdict.within.all(), {name: int((~verdict.within[part]).sum()) for name, part in where.items()}


def points(count: int) -> dict[str, np.ndarray]:
    """Points in and around a box of 4 × 3 × 2 m, seen from everywhere."""
    rng = np.random.default_rng(5)
    return {
        "Offset": np.zeros((count, 3)),
        "Position": rng.uniform(-1.1, 1.1, (count, 3)) * (2.0, 1.5, 1.0) + (3.0, -2.0, 1.0),
        "Incoming": directions(count, rng),
        "Normal": directions(count, rng),
        "Box Centre": np.broadcast_to((3.0, -2.0, 1.0), (count, 3)),
        **{f"Face Normal {axis}": np.broadcast_to(np.eye(3)[k], (count, 3)) for k, axis in enumerate("XYZ")},
        "Half Widths": np.broadcast_to((2.0, 1.5, 1.0), (count, 3)),
        "Capture Point": np.broadcast_to((3.2, -2.0, 1.1), (count, 3)),
        "Padding": np.full(count, 0.01),
        "Falloff": np.full(count, 0.25),
        "Boundary": np.full(count, 1e-5),
    }


@pytest.mark.parametrize("outside", [*Outside, None])
def test_a_probe_shows_the_radiance_that_numpy_reads_from_its_pictures(driver: None, outside: Outside | None) -> None:
    effects = LookupEffects(Correction.ORIENTED_BOX, outside, True, hardening=True)
    formula = lookup.probe(effects, {"Level 0": 64}, {"Direction": lookup.MIRRORED}, shares=True)
    rows, columns = np.mgrid[0:64, 0:128]
    smooth = np.stack([np.sin(columns * np.pi / 32.0), np.cos(rows * np.pi / 64.0), rows / 64.0], -1) + 1.0
    pictures = {"Level 0": smooth.astype(np.float32)}
    inputs = points(2000)
    found, expected = run(formula, inputs, pictures), evaluate(formula.outputs, inputs, np.float32, pictures)
    near = expected["Depth"] > -1e3  # what faces away is far outside
    np.testing.assert_allclose(found["Depth"][near], expected["Depth"][near], atol=1e-5)
    assert (found["Depth"][~near] < -1e3).all() and 0.02 < near.mean() < 1.0
    np.testing.assert_allclose(found["Spread"], expected["Spread"], atol=1e-4)
    np.testing.assert_allclose(found["Level 0"], expected["Level 0"], atol=0.01)  # drivers filter with 8 bits


@pytest.mark.parametrize("formula", FORMULAS[-2:], ids=["bare", "under a film"])
def test_a_surface_reflects_what_numpy_says(driver: None, formula: Formula) -> None:
    rng = np.random.default_rng(6)
    count = 2000
    normal, incoming = directions(count, rng), directions(count, rng)
    inputs = {
        "Radiance": rng.random((count, 3)),
        "Base Color": rng.random((count, 3)),
        "Metallic": rng.random(count),
        "Captured": rng.random(count),
        "Thin Film Thickness": rng.uniform(0.0, 1000.0, count),
        "Thin Film IOR": rng.uniform(1.0, 2.0, count),
        "Roughness": rng.random(count) * 0.6,
        "Specular IOR Level": rng.random(count),
        "Specular Tint": rng.random((count, 3)),
        "Normal": normal,
        "Incoming": incoming * np.sign((normal * incoming).sum(-1, keepdims=True)),
    }
    inputs = {name: inputs[name] for name in formula.inputs}
    found, expected = run(formula, inputs), evaluate(formula.outputs, inputs)
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, atol=2e-4)


def test_a_rough_surface_is_looked_up_where_numpy_looks(driver: None) -> None:
    rng = np.random.default_rng(7)
    normal, incoming = directions(2000, rng), directions(2000, rng)
    incoming *= np.sign((normal * incoming).sum(-1, keepdims=True))
    inputs = {"Normal": normal, "Incoming": incoming, "Roughness": rng.random(2000), "Metallic": rng.random(2000)}
    formula = dominant((dielectric_facets(1.5), METAL))
    found, expected = run(formula, inputs), evaluate(formula.outputs, inputs)
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, atol=1e-5)


def test_random_numbers_are_the_same_bit_by_bit(driver: None) -> None:
    rng = np.random.default_rng(9)
    keys = np.concatenate([rng.integers(-500, 500, (2000, 3)), rng.normal(size=(2000, 3))]).astype(np.float32)
    formula = Formula("Noise", {"Numbers": random(vector("Key"))})
    found, expected = run(formula, {"Key": keys}), evaluate(formula.outputs, {"Key": keys}, np.float32)
    np.testing.assert_allclose(found["Numbers"], expected["Numbers"], rtol=3e-7)


def test_a_pane_shows_the_rooms_that_numpy_sees(driver: None) -> None:
    rng = np.random.default_rng(10)
    count = 2000
    whole = interior(Interior((RoomPicture(rows=64), RoomPicture(capture=(0.2, 0.1, 0.0), rows=64)), middle=True))
    varying = {"Position", "Incoming", "Normal", "Up", "Seed"}
    known = {name: 0.5 if part.width == 1 else (1.0, 1.0, 1.0) for name, part in whole.inputs.items()}
    calls = whole(**{name.replace(" ", "_"): value for name, value in known.items() if name not in varying})
    formula = Formula("Pane", {name: calls[name] for name in whole.outputs})
    inputs = {
        "Position": rng.uniform(-9.0, 9.0, (count, 3)),
        "Incoming": directions(count, rng),
        "Normal": np.tile((0.0, -1.0, 0.0), (count, 1)),
        "Up": np.tile((0.0, 0.0, 1.0), (count, 1)),
        "Seed": rng.integers(0, 100, count),
    }
    rows, columns = np.mgrid[0:64, 0:128]
    smooth = np.stack([np.sin(columns * np.pi / 32.0), np.cos(rows * np.pi / 64.0), rows / 64.0], -1) + 1.0
    flat = np.concatenate([np.cos(np.mgrid[0:64, 0:64] / 20.0).transpose(1, 2, 0), np.full((64, 64, 2), 0.5)], -1)
    pictures = {"Middle Picture": flat, "Room 0": smooth, "Room 1": smooth[:, ::-1]}
    found, expected = run(formula, inputs, pictures), evaluate(formula.outputs, inputs, np.float32, pictures)
    np.testing.assert_array_equal(found["Cell"], expected["Cell"])
    np.testing.assert_array_equal(found["Is Lit"], expected["Is Lit"])
    assert expected["Is Lit"].min() < expected["Is Lit"].max()
    wrong = np.abs(found["Radiance"] - expected["Radiance"]).max(-1) > 0.02  # drivers filter with 8 bits
    assert wrong.mean() < 0.01, "but where a layer begins"
