"""Exports: each engine's axes, cubemaps, levels and numbers; the containers; the folder."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core import equirect
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as blender_lookup
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.errors import PccError
from pcc_addon.core.export import containers, cubemaps, document, folder, lookup
from pcc_addon.core.export.document import ExportedProbe
from pcc_addon.core.export.shader import shader
from pcc_addon.core.export.target import Picture, Target
from pcc_addon.core.export.targets import TARGETS, target_of
from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import Box, ProbeSpec
from pcc_addon.core.sidecar import Sidecar
from tests.core.boxes import directions

SIDES = {
    "+X": (1, 0, 0), "-X": (-1, 0, 0), "+Y": (0, 1, 0), "-Y": (0, -1, 0), "+Z": (0, 0, 1), "-Z": (0, 0, -1)
}  # fmt: skip
# Which wall of Blender's is in the middle, at the top and at the right of each face of the file, px nx py ny pz nz.
# Worked out by hand from each engine's manual and its import of glTF; tests/engines asks the engines themselves.
_MIRRORED = ["-X +Z +Y", "+X +Z -Y", "+Z +Y -X", "-Z -Y -X", "-Y +Z -X", "+Y +Z +X"]
FACES = {
    "three": _MIRRORED,
    "babylon": _MIRRORED,
    "playcanvas": _MIRRORED,
    "unity": _MIRRORED,
    "godot": ["+X +Z +Y", "-X +Z -Y", "+Z +Y +X", "-Z -Y +X", "-Y +Z +X", "+Y +Z -X"],
    "unreal": ["+X -Y -Z", "-X -Y +Z", "-Y -Z +X", "+Y +Z +X", "+Z -Y +X", "-Z -Y -X"],
    "generic": ["+X +Z -Y", "-X +Z +Y", "+Z -Y +X", "-Z +Y +X", "+Y +Z +X", "-Y +Z -X"],
}
EVERY_TARGET = pytest.mark.parametrize("target", TARGETS, ids=lambda t: t.key)


def marked(height: int = 64) -> np.ndarray:
    """A picture whose colour is its direction, made positive."""
    return (equirect.directions(2 * height, height) + 2.0).astype(np.float32)


@EVERY_TARGET
def test_each_face_of_the_file_has_the_walls_that_the_engine_s_manual_puts_there(target: Target) -> None:
    level = cubemaps.level(marked(), target.from_sampler, 33, sharp=True) - 2.0
    for face, walls in zip(level, FACES[target.key], strict=True):
        middle, top, right = (np.array(SIDES[side], float) for side in walls.split())
        np.testing.assert_allclose(face[16, 16], middle, atol=0.01)
        assert face[0, 16] @ top > 0.65 and face[16, 32] @ right > 0.65


@EVERY_TARGET
def test_a_sampler_finds_along_a_world_direction_what_was_captured_there(target: Target) -> None:
    level = cubemaps.level(marked(), target.from_sampler, 64, sharp=True)
    d = directions(500, np.random.default_rng(1))
    in_world = d @ target.axes.matrix.T
    found = cubemaps.sample(level, in_world @ target.sampled.matrix.T) - 2.0
    assert np.abs(found - d).max() < 0.03
    mirrored = cubemaps.sample(level, (in_world * (-1, 1, 1)) @ target.sampled.matrix.T) - 2.0
    assert np.abs(mirrored - d).max() > 0.5


def test_the_sharp_lookup_goes_across_poles_and_the_meridian() -> None:
    d = np.array([(0, 0, 1), (0, 0, -1), (-1, 1e-9, 0), (-1, -1e-9, 0), (0.3, -0.2, 5.0)], float)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    np.testing.assert_allclose(cubemaps.bicubic_lookup(marked(), d) - 2.0, d, atol=2e-3)


def a_probe(outside: Outside = Outside.OWN, **more: object) -> ProbeSpec:
    rng = np.random.default_rng(4)
    matrix = np.eye(4)
    turned, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    matrix[:3, :3], matrix[:3, 3] = turned * (3.0, 2.0, 1.5), (4.0, -2.0, 1.0)
    return ProbeSpec("Hall", Box.from_matrix("Hall", matrix), outside=outside, **more)


_FACES_DIFFER = Influence((0.1, 0.2, 0.0), (0.0, 0.3, -0.1), (0.1, 0.2, 0.3), (0.3, 0.2, 0.1), 0.2, 0.8)


@EVERY_TARGET
@pytest.mark.parametrize(
    "spec",
    [
        *(a_probe(outside) for outside in Outside),
        a_probe(influence=_FACES_DIFFER, contact_hardening=True),
        a_probe(corrected=False),
    ],
    ids=[*(outside.value for outside in Outside), "faces differ", "uncorrected"],
)
def test_engines_look_where_blender_does(target: Target, spec: ProbeSpec) -> None:
    rng = np.random.default_rng(5)
    captured_at = tuple(spec.box.centre + np.array((0.3, -0.2, 0.1)))
    effects, rungs = lookup.effects_of(spec, captured_at), target.roughnesses(256)
    points = spec.box.centre + rng.uniform(-1.15, 1.15, (400, 3)) @ spec.box.axes.T
    incoming, normal, rough = directions(400, rng), directions(400, rng), rng.uniform(0.0, 1.0, 400)
    of_surface = {
        "Position": target.units * points @ target.axes.matrix.T,
        "Incoming": incoming @ target.axes.matrix.T,
        "Normal": normal @ target.axes.matrix.T,
        "Roughness": rough,
    }
    numbers = {name: np.array(value) for name, value in lookup.numbers(spec, captured_at, target).items()}
    found = evaluate(lookup.formula(effects, rungs).outputs, of_surface | numbers, np.float64)
    here = lookup.numbers(spec, captured_at, replace(target_of("generic")))
    blender = {"Position": points, "Incoming": incoming, "Normal": normal} | {n: np.array(v) for n, v in here.items()}
    expected = evaluate(blender_lookup.lookup(effects), blender, np.float64)
    back = found["Direction"] @ target.axes.matrix
    cosines = (back * expected["Direction"]).sum(-1)
    cosines /= np.linalg.norm(back, axis=-1) * np.linalg.norm(expected["Direction"], axis=-1)
    assert cosines.min() > 1.0 - 1e-9
    weight = expected["Weight"] * expected.get("Presence", 1.0)
    np.testing.assert_allclose(found["Weight"] * found["Brightness"], np.broadcast_to(weight, 400), atol=1e-6)
    spread = rough * expected.get("Spread", 1.0)
    np.testing.assert_allclose(found["Level"], np.interp(spread, rungs, range(len(rungs))), atol=1e-9)


def test_levels_are_where_each_engine_s_own_materials_look_for_them() -> None:
    babylon, unity, unreal = (np.array(target_of(key).roughnesses(256)) for key in ("babylon", "unity", "unreal"))
    levels = [np.arange(1, len(r)) for r in (babylon, unity, unreal)]
    below_one = babylon[1:] < 1.0
    np.testing.assert_allclose(0.8 * np.log2(babylon[1:] ** 2 * 256)[below_one], levels[0][below_one])
    np.testing.assert_allclose(6.0 * unity[1:] * (1.7 - 0.7 * unity[1:]), levels[1])
    np.testing.assert_allclose(9 - 1 - (1.0 - 1.2 * np.log2(unreal[1:])), levels[2])  # of nine levels
    np.testing.assert_allclose([babylon[-1], unity[-1], unreal[-1]], 1.0)


@EVERY_TARGET
@pytest.mark.parametrize("width", [16, 64, 512, 4096])
def test_levels_ascend_and_their_texels_suffice_for_their_lobes(target: Target, width: int) -> None:
    rungs = np.array(target.roughnesses(width))
    assert rungs[0] == 0.0 and (np.diff(rungs) > 0.0).all() and rungs[-1] <= 1.0
    if target.key in {"three", "godot", "generic", "playcanvas"}:
        texels = (np.pi / 2.0) / (width >> np.arange(1, len(rungs)))
        radius = 2.0 * np.arctan(rungs[1:] ** 2)  # of half the lobe's energy
        assert (texels < 1.5 * radius).all()


def two_levels() -> list[np.ndarray]:
    rng = np.random.default_rng(2)
    return [rng.uniform(0.0, 9.0, (6, n, n, 3)).astype(np.float16).astype(np.float32) for n in (4, 2)]


def test_dds_has_each_face_with_its_levels() -> None:
    levels = two_levels()
    text = containers.dds(levels)
    assert text[:4] == b"DDS " and struct.unpack_from("<I", text, 4) == (124,)
    height, width = struct.unpack_from("<2I", text, 12)
    assert (height, width, *struct.unpack_from("<I", text, 28)) == (4, 4, 2)
    assert struct.unpack_from("<3I", text, 76) == (32, 4, 113)
    assert struct.unpack_from("<2I", text, 108) == (0x401008, 0xFE00)
    texels = np.frombuffer(text, "<f2", offset=128).reshape(6, -1, 4)
    for k in range(6):
        np.testing.assert_array_equal(texels[k, :16, :3], levels[0][k].reshape(-1, 3))
        np.testing.assert_array_equal(texels[k, 16:, :3], levels[1][k].reshape(-1, 3))
    assert (texels[..., 3] == 1.0).all()


def test_ktx2_has_each_level_with_its_faces() -> None:
    levels = two_levels()
    text = containers.ktx2(levels, "tests")
    assert text[:12] == b"\xabKTX 20\xbb\r\n\x1a\n"
    assert struct.unpack_from("<9I", text, 12) == (97, 2, 4, 4, 0, 0, 6, 2, 0)
    for k, level in enumerate(levels):
        start, length, uncompressed = struct.unpack_from("<3Q", text, 80 + 24 * k)
        assert start % 8 == 0 and length == uncompressed == level.size // 3 * 8 and start + length <= len(text)
        texels = np.frombuffer(text[start : start + length], "<f2").reshape(*level.shape[:3], 4)
        np.testing.assert_array_equal(texels[..., :3], level)
    start, length = struct.unpack_from("<2I", text, 48)
    assert struct.unpack_from("<I", text, start) == (length,)


def test_what_is_brighter_than_half_floats_is_as_bright_as_they_go() -> None:
    bright = [np.full((6, 1, 1, 3), 1e9, np.float32)]
    assert np.frombuffer(containers.dds(bright), "<f2", offset=128).max() == np.float16(65504.0)


@EVERY_TARGET
def test_the_document_is_json_in_the_engine_s_axes_and_units(target: Target) -> None:
    spec = a_probe()
    captured_at = (4.5, -2.0, 1.0)
    record = Sidecar.of_bake(spec, "uid", seconds=0.0, content_hash="", blender="", addon="")
    rungs = target.roughnesses(64)
    effects = lookup.effects_of(spec, captured_at)
    probe = ExportedProbe(spec, record, captured_at, effects, 64, rungs, "Hall.glsl", {Picture.DDS.value: "Hall.dds"})
    plain = json.loads(document.document([probe], target, "1", {"Hall.dds": "0"}))
    assert document.files_of(json.dumps(plain), "here") == {"Hall.dds": "0"}
    [found] = plain["probes"]
    expected = target.units * (target.axes.matrix @ captured_at)
    np.testing.assert_allclose(found["capture_point"], expected)
    edges = np.array(found["box"]["half_edges"]) @ target.axes.matrix / target.units
    np.testing.assert_allclose(edges.T, spec.box.axes)
    text = shader(probe.formula, lookup.numbers(spec, captured_at, target), target, "Heading")
    assert all(name in text for name in found["numbers"]) and "nan" not in text


def test_relief_and_stretching_are_not_asked_of_engines() -> None:
    spec = a_probe(relief=True)
    assert lookup.effects_of(spec, tuple(spec.box.centre)).steps == 0
    found = lookup.effects_of(replace(spec, corrected=False), tuple(spec.box.centre))
    assert found == LookupEffects(Correction.NONE, None, False)


def write(parts: Path, files: dict[str, bytes]) -> list[str]:
    for name, content in files.items():
        (parts / name).write_bytes(content)
    names = sorted(files)
    known = {name: folder.digest(parts / name) for name in names}
    (parts / document.NAME).write_text(document.document([], target_of("three"), "1", known))
    return names


def put(to: Path, files: dict[str, bytes]) -> None:
    with folder.parts_of(to) as parts:
        folder.publish(parts, to, write(parts, files))


def listing(to: Path) -> set[str]:
    return {path.name for path in to.iterdir()}


def test_an_export_replaces_what_an_export_wrote_and_nothing_else(tmp_path: Path) -> None:
    to = tmp_path / "new" / "out"
    put(to, {"a.dds": b"1", "b.dds": b"2"})
    (to / "notes.txt").write_text("mine")
    put(to, {"a.dds": b"3"})
    assert listing(to) == {"a.dds", "notes.txt", document.NAME}
    assert (to / "a.dds").read_bytes() == b"3" and (to / "notes.txt").read_text() == "mine"


def test_files_of_others_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    put(tmp_path, {"a.dds": b"1"})
    (tmp_path / "b.dds").write_bytes(b"theirs")
    with pytest.raises(PccError, match=r"b\.dds' was not written by an export"):
        put(tmp_path, {"a.dds": b"3", "b.dds": b"2"})
    assert (tmp_path / "a.dds").read_bytes() == b"1" and (tmp_path / "b.dds").read_bytes() == b"theirs"
    (tmp_path / "b.dds").unlink()
    (tmp_path / "a.dds").write_bytes(b"changed by hand")
    with pytest.raises(PccError, match="changed since"):
        put(tmp_path, {"a.dds": b"3"})
    put(tmp_path, {"c.dds": b"4"})
    assert (tmp_path / "a.dds").read_bytes() == b"changed by hand", "no longer ours, so it stays"


def test_an_export_that_was_stopped_while_it_moved_its_files_can_be_done_again(tmp_path: Path) -> None:
    (tmp_path / "a.dds").write_bytes(b"1")  # moved, but not yet told of
    put(tmp_path, {"a.dds": b"1", "b.dds": b"2"})
    assert listing(tmp_path) == {"a.dds", "b.dds", document.NAME}


def test_a_listing_cannot_name_files_elsewhere(tmp_path: Path) -> None:
    to, outside = tmp_path / "out", tmp_path / "precious.dds"
    outside.write_bytes(b"1")
    put(to, {"a.dds": b"1"})
    (to / "link.dds").symlink_to(outside)
    plain = json.loads((to / document.NAME).read_text())
    plain["files"] |= {name: folder.digest(outside) for name in ("../precious.dds", str(outside), "link.dds")}
    (to / document.NAME).write_text(json.dumps(plain))
    put(to, {"a.dds": b"2"})
    assert outside.read_bytes() == b"1" and (to / "link.dds").is_symlink()


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": "other", "files": {}}', "[" * 10_000])
def test_a_listing_that_is_none_is_left_alone(tmp_path: Path, text: str) -> None:
    (tmp_path / document.NAME).write_text(text)
    with pytest.raises(PccError, match="is not of an export"):
        put(tmp_path, {"a.dds": b"1"})
    assert listing(tmp_path) == {document.NAME}


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(PccError, match="is a file"), folder.parts_of(tmp_path / "out"):
        pass
