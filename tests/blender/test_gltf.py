"""Probes survive Blender's glTF exporter and importer, and other tools can read them."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

import pcc_addon
from pcc_addon import gltf_hooks
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.core.export import gltf
from pcc_addon.core.export.axes import Axes
from tests.blender.helpers import bake, small_probe, small_room
from tests.engines import packages


@pytest.fixture(autouse=True)
def listed(scene, monkeypatch) -> Iterator[None]:
    """The add-on as Blender's own exporter finds it: among the enabled ones, with the names that it asks for."""
    pytest.importorskip("addon_utils")
    import addon_utils

    if addon_utils.enable("io_scene_gltf2") is None:
        pytest.skip("this Blender comes without its glTF exporter")
    for name in ("glTF2ExportUserExtension", "glTF2ImportUserExtension"):
        monkeypatch.setattr(pcc_addon, name, getattr(gltf_hooks, name), raising=False)
    entry = bpy.context.preferences.addons.new()
    entry.module = "pcc_addon"
    yield
    bpy.context.preferences.addons.remove(bpy.context.preferences.addons["pcc_addon"])


def write(path: Path, **options: object) -> dict:
    """Export the file as GLB; returns its JSON."""
    assert bpy.ops.export_scene.gltf(filepath=str(path), **options) == {"FINISHED"}
    return read_json(path)


def read_json(path: Path) -> dict:
    content = path.read_bytes()
    [length] = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + length])


def node_of(document: dict) -> dict:
    return next(node for node in document["nodes"] if gltf.NAME in node.get("extensions", {}))


def set_up() -> bpy.types.Object:
    probe = small_probe("Hall", (3.0, -2.0, 1.0), (2.0, 1.5, 1.0), (0.3, -0.2, 0.9), (0.4, -0.3, 0.2))
    probe.empty_display_size, probe.scale = 0.5, [2.0 * v for v in probe.scale]
    settings = probe.pcc_probe
    settings.resolution, settings.samples, settings.outside, settings.correction = 96, 7, "BLACK", "RELIEF"
    settings.influence_low, settings.influence_high = (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)
    settings.priority, settings.weight, settings.falloff = 3, 0.5, 0.75
    bpy.context.view_layer.update()
    return probe


def test_a_probe_comes_back_as_it_was(tmp_path: Path) -> None:
    before = probe_spec(set_up())
    document = write(tmp_path / "hall.glb")
    assert gltf.NAME in document["extensionsUsed"] and gltf.NAME not in document.get("extensionsRequired", [])
    bpy.data.batch_remove(list(bpy.data.objects))
    assert bpy.ops.import_scene.gltf(filepath=str(tmp_path / "hall.glb")) == {"FINISHED"}
    probe = bpy.data.objects["Hall"]
    bpy.context.view_layer.update()
    after = probe_spec(probe)
    assert probe.pcc_probe.is_probe and probe.empty_display_type == "CUBE"
    np.testing.assert_allclose(after.box.matrix, before.box.matrix, atol=1e-5)
    np.testing.assert_allclose(after.capture_point, before.capture_point, atol=1e-5)
    for name in ("resolution", "samples", "outside", "relief", "influence", "falloff", "engine", "denoise"):
        assert getattr(after, name) == getattr(before, name), name


def test_others_read_box_capture_point_and_influence_in_gltf_s_axes(tmp_path: Path) -> None:
    probe = set_up()
    spec = probe_spec(probe)
    node = node_of(write(tmp_path / "hall.glb"))
    found, axes = node["extensions"][gltf.NAME], Axes("+X", "+Z", "-Y").matrix
    w, x, y, z = (node["rotation"][k] for k in (3, 0, 1, 2))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    edges = turn * node["scale"] * found["halfExtents"]
    np.testing.assert_allclose(np.abs(edges), np.abs((axes @ spec.box.axes)[:, [0, 2, 1]]), atol=1e-5)
    captured_at = np.array(node["translation"]) + turn @ found["captureOffset"]
    np.testing.assert_allclose(captured_at, axes @ spec.capture_point, atol=1e-5)
    np.testing.assert_allclose(found["influence"]["low"], (0.1, 0.3, 0.5), atol=1e-6)
    np.testing.assert_allclose(found["influence"]["high"], (0.4, 0.6, 0.2), atol=1e-6)
    assert "levels" not in found, "it is not baked"


def test_a_baked_probe_has_its_cubemap_in_the_file(tmp_path: Path) -> None:
    probe = small_room()
    assert bake(probe)[0].error is None
    document = write(tmp_path / "room.glb")
    levels = node_of(document)["extensions"][gltf.NAME]["levels"]
    content = (tmp_path / "room.glb").read_bytes()
    [length] = struct.unpack_from("<I", content, 12)
    view = document["bufferViews"][levels["bufferView"]]
    start = 20 + length + 8 + view.get("byteOffset", 0)
    picture = content[start : start + view["byteLength"]]
    assert picture[:12] == b"\xabKTX 20\xbb\r\n\x1a\n" and struct.unpack_from("<I", picture, 20) == (
        levels["faceWidth"],
    )
    assert levels["faceWidth"] == 16 and len(levels["roughnesses"]) > 2


@pytest.mark.parametrize("found", [None, [], 3, {}, {"version": 1}, {"version": 1, "halfExtents": [0.0], "blender": {}},
                                   {"version": 99, "halfExtents": [1.0], "blender": {}}])  # fmt: skip
def test_what_is_no_probe_stays_an_empty(tmp_path: Path, found: object) -> None:
    item = bpy.data.objects.new("Empty", None)

    class Log:
        told: list[str] = []

        def warning(self, text: str) -> None:
            self.told.append(text)

    from pcc_addon.blender.gltf import import_node

    node = type("Node", (), {"extensions": {gltf.NAME: found}})()
    import_node(node, item, Log())
    assert not item.pcc_probe.is_probe and (found is None or "'Empty'" in Log.told[-1])


def test_settings_that_anybody_wrote_change_nothing_else(tmp_path: Path) -> None:
    from pcc_addon.blender.gltf import import_node

    item = bpy.data.objects.new("Empty", None)
    settings = {"resolution": "many", "outside": "NOWHERE", "weight": [1], "samples": 5, "bake_record": "x", "uid": "x"}
    node = type("Node", (), {"extensions": {gltf.NAME: {"version": 1, "halfExtents": [1.0], "blender": settings}}})()
    import_node(node, item, None)
    probe = item.pcc_probe
    assert probe.is_probe and probe.samples == 5 and probe.outside == "OWN" and not probe.bake_record and not probe.uid


@pytest.mark.heavy
def test_khronos_own_validator_finds_no_fault(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node, to run Khronos' validator")
    modules = packages.installed("gltf-validator")
    probe = small_room()
    bake(probe)
    write(tmp_path / "room.glb")
    script = (
        "const v = require(process.argv[1] + '/gltf-validator');"
        "v.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))"
        ".then((report) => console.log(JSON.stringify(report.issues)))"
    )
    done = subprocess.run(
        [node, "-e", script, str(modules), str(tmp_path / "room.glb")], capture_output=True, text=True
    )
    issues = json.loads(done.stdout)
    assert issues["numErrors"] == 0, issues["messages"]
