"""Files that earlier versions baked and injected open, show, report, inject and bake as if made today."""

from __future__ import annotations

import shutil
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.shade.injection import remove
from pcc_addon.blender.shade.twin import shown_probe_groups
from pcc_addon.blender.status import statuses
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import principled_node
from tests.blender.helpers import bake, picture, put_in

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures" / "v1"
OLD_LEVELS = (0.0, 0.12, 0.3)
EARLIER = "it was baked by an earlier version of the add-on, which looked at other things; bake it again"


@pytest.fixture(params=["baked", "packed"])
def probe(request, scene, tmp_path) -> bpy.types.Object:
    """The probe of a file of version 1, opened from a copy."""
    shutil.copytree(FIXTURES, tmp_path / "v1")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "v1" / f"{request.param}.blend"))
    return bpy.data.objects["Probe"]


def needed() -> list[float]:
    """The roughnesses that the plan wants pictures for."""
    [plan] = plan_scene(bpy.context.scene, bpy.context.view_layer).probes
    assert len(OLD_LEVELS) < len(plan.roughnesses) < len(LADDER)
    return list(plan.roughnesses)


def state() -> tuple[str, str]:
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    return status.state, status.why


def test_it_says_why_it_is_stale_and_its_record_is_read(probe) -> None:
    assert state() == ("stale", EARLIER)
    assert [level.roughness for level in bake_record(probe).levels] == pytest.approx(OLD_LEVELS)


def test_its_shader_is_brought_up_to_date_and_its_materials_still_show_it(probe) -> None:
    assert probe_group.is_current(probe)
    for name in ("Floor", "Copper", "Sign"):
        material = bpy.data.materials[name]
        assert shown_probe_groups(material) == (probe.pcc_probe.group,)
        output = material.node_tree.get_output_node("CYCLES")
        assert marks.role(output), "the twin is in force"
        used = [n for n in material.node_tree.nodes if marks.role(n) == "probe"]
        assert used and all(any(s.is_linked for s in n.outputs) for n in used)


def test_removing_restores_the_materials_exactly(probe) -> None:
    assert sorted(remove()) == ["Copper", "Floor", "Sign"]
    for name in ("Floor", "Copper", "Sign"):
        tree = bpy.data.materials[name].node_tree
        assert sorted(n.name for n in tree.nodes) == ["Material Output", "Principled BSDF"]
        assert tree.get_output_node("CYCLES").is_active_output
        assert tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node == principled_node(
            bpy.data.materials[name]
        )
        assert bpy.data.materials[name].cycles.emission_sampling == "AUTO"


def test_injecting_makes_the_missing_levels_from_the_old_capture(probe) -> None:
    before = picture(probe).copy()
    put_in()
    found = [level.roughness for level in probe.pcc_probe.levels]
    assert found == pytest.approx(sorted({*needed(), *OLD_LEVELS}))
    assert np.array_equal(picture(probe), before)
    assert state() == ("stale", EARLIER)


def test_baking_again_makes_todays_levels_alone(probe) -> None:
    [result] = bake(probe)
    assert result.error is None
    assert [level.roughness for level in probe.pcc_probe.levels] == pytest.approx(needed())
    assert state() == ("baked", "")


@pytest.mark.sweep
@pytest.mark.parametrize("harm", ["missing", "truncated", "empty", "another's"])
def test_a_picture_that_is_not_the_one_that_was_baked_makes_it_stale_and_harms_no_shader(probe, harm) -> None:
    if probe.pcc_probe.levels[0].image.packed_file:
        pytest.skip("its pictures are inside the file")
    bake(probe)
    path = Path(bpy.path.abspath(probe.pcc_probe.levels[1].image.filepath))
    whole = path.read_bytes()
    if harm == "missing":
        path.unlink()
    else:
        path.write_bytes({"truncated": whole[: len(whole) // 2], "empty": b"", "another's": whole + b"x"}[harm])
    probe.pcc_probe.levels[1].image.reload()
    before = len(probe.pcc_probe.group.nodes)
    kept, why = state()
    assert kept == "stale" and str(path) in why and "bake it again" in why
    if harm != "another's":
        with pytest.raises(RuntimeError, match="cannot be read"):
            bpy.ops.pcc.inject()
        assert len(probe.pcc_probe.group.nodes) == before
    bake(probe)
    assert state() == ("baked", "")
