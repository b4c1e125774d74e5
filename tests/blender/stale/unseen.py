"""What editors show, what renders leave out, and frames that change nothing."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, fresh, settings_rows
from tests.blender.stale.things import (
    collection,
    drawing,
    geometry_nodes,
    group,
    keyed,
    rig,
    scene,
    surface,
    the,
    thing,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@fresh("editors", "an object selected and active")
def _(folder: Path) -> Steps:
    yield
    the().select_set(True)
    bpy.context.view_layer.objects.active = the()


@fresh("editors", "into edit mode")
def _(folder: Path) -> Steps:
    the().data.polygons[0].use_smooth = True
    yield
    bpy.context.view_layer.objects.active = the()
    bpy.ops.object.mode_set(mode="EDIT")


@fresh("editors", "into edit mode and back, with things chosen and hidden there")
def _(folder: Path) -> Steps:
    yield
    bpy.context.view_layer.objects.active = the()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.hide(unselected=False)
    bpy.ops.object.mode_set(mode="OBJECT")


@fresh("editors", "into sculpt mode and vertex paint")
def _(folder: Path) -> Steps:
    yield
    bpy.context.view_layer.objects.active = the()
    for mode in ("SCULPT", "OBJECT", "WEIGHT_PAINT", "OBJECT"):
        bpy.ops.object.mode_set(mode=mode)


@fresh("editors", "the cursor")
def _(folder: Path) -> Steps:
    yield
    scene().cursor.location = (1.0, 2.0, 3.0)


@fresh("editors", "a workspace's name")
def _(folder: Path) -> Steps:
    yield
    for workspace in bpy.data.workspaces:
        workspace.name = f"Renamed {workspace.name}"


@fresh("editors", "an annotation")
def _(folder: Path) -> Steps:
    yield
    if hasattr(bpy.data, "annotations"):
        scene().annotation = bpy.data.annotations.new("Note")
    else:
        scene().grease_pencil = bpy.data.grease_pencils.new("Note")


@fresh("editors", "hidden in the viewport")
def _(folder: Path) -> Steps:
    the().modifiers.new("Subdivision", "SUBSURF")
    yield
    the().hide_set(True)


@fresh("editors", "disabled in viewports")
def _(folder: Path) -> Steps:
    the().modifiers.new("Subdivision", "SUBSURF")
    yield
    the().hide_viewport = True


@fresh("editors", "a collection disabled in viewports")
def _(folder: Path) -> Steps:
    made = collection("Some", the())
    yield
    made.hide_viewport = True


settings_rows(
    False, "editors", the, "{}", CYCLES, show_name=True, display_type="WIRE", show_in_front=True, hide_select=True,
    lock_location=(True, True, True),
)  # fmt: skip


@fresh("editors", "a modifier's viewport, panel and levels there")
def _(folder: Path) -> Steps:
    made = the().modifiers.new("Subdivision", "SUBSURF")
    yield
    made.show_viewport, made.show_expanded, made.levels = False, False, 3


@fresh("not rendered", "an edit of an object hidden in renders")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.hide_render = True
    yield
    other.location.x, other.data.vertices[0].co.x = 3.0, 2.0


@fresh("not rendered", "an edit in an excluded collection")
def _(folder: Path) -> Steps:
    other = thing("Other")
    collection("Some", other)
    bpy.context.view_layer.layer_collection.children["Some"].exclude = True
    yield
    other.location.x, other.data.vertices[0].co.x = 3.0, 2.0


@fresh("not rendered", "an edit in a collection hidden in renders")
def _(folder: Path) -> Steps:
    other = thing("Other")
    collection("Some", other).hide_render = True
    yield
    other.location.x, other.data.vertices[0].co.x = 3.0, 2.0


def only_for_cameras() -> bpy.types.Object:
    other = thing("Other")
    for kind in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(other, f"visible_{kind}", False)
    return other


@fresh("not rendered", "an edit of what only cameras see")
def _(folder: Path) -> Steps:
    other = only_for_cameras()
    yield
    other.location.x = 3.0


@fresh("not rendered", "an edit of what only cameras see, by EEVEE", EEVEE)
def _(folder: Path) -> Steps:
    other = only_for_cameras()
    yield
    other.location.x = 3.0


@fresh("not rendered", "what is left out of the camera's picture alone")
def _(folder: Path) -> Steps:
    collection("Some", the())
    yield
    layer = bpy.context.view_layer.layer_collection.children["Some"]
    layer.holdout, layer.indirect_only = True, True
    the().is_holdout, the().visible_camera = True, False


@fresh("not rendered", "a modifier that renders leave out")
def _(folder: Path) -> Steps:
    made = the().modifiers.new("Bevel", "BEVEL")
    made.show_render = False
    yield
    made.width += 0.1


@fresh("not rendered", "a second UV map that nobody reads")
def _(folder: Path) -> Steps:
    the().data.uv_layers["UV"].active_render = True
    yield
    made = the().data.uv_layers.new(name="Second")
    made.uv[0].vector = (0.3, 0.3)


@fresh("not rendered", "sharp edges and materials of faces that were set and set back")
def _(folder: Path) -> Steps:
    the().data.materials.append(bpy.data.materials.new("Second"))
    yield
    for value in (True, False):
        the().data.edges[0].use_edge_sharp, the().data.polygons[0].material_index = value, int(value)


@fresh("not rendered", "a shape key of value 0")
def _(folder: Path) -> Steps:
    key = keyed()
    key.value = 0.0
    yield
    key.data[0].co.x += 1.0


@fresh("not rendered", "a bone that moves nothing")
def _(folder: Path) -> Steps:
    armature = rig()
    yield
    armature.pose.bones["Idle"].rotation_quaternion = (0.8, 0.6, 0.0, 0.0)


@fresh("not rendered", "a vertex group that nothing uses")
def _(folder: Path) -> Steps:
    yield
    the().vertex_groups.new(name="Some").add([0], 1.0, "REPLACE")


@fresh("not rendered", "colour, pass index and properties that no shader reads")
def _(folder: Path) -> Steps:
    yield
    the().color, the().pass_index, the()["mine"] = (1.0, 0.0, 0.0, 1.0), 7, 3.0


@fresh("not rendered", "EEVEE's light probes, by Cycles")
def _(folder: Path) -> Steps:
    yield
    bpy.ops.object.lightprobe_add(type="SPHERE")


@fresh("frame", "another one, where nothing follows it")
def _(folder: Path) -> Steps:
    group(), keyed(), geometry_nodes(the())
    the().modifiers.new("Subdivision", "SUBSURF")
    yield
    scene().frame_set(scene().frame_current + 7)


@fresh("frame", "keyframes that change nothing now")
def _(folder: Path) -> Steps:
    scene().frame_set(1)
    yield
    the().keyframe_insert("location", frame=1)
    surface().inputs["Roughness"].keyframe_insert("default_value", frame=1)


@fresh("frame", "another one, where hair stands still")
def _(folder: Path) -> Steps:
    the().modifiers.new("Particles", "PARTICLE_SYSTEM")
    the().particle_systems[0].settings.type = "HAIR"
    yield
    scene().frame_set(scene().frame_current + 7)


@fresh("frame", "another one, where a drawing stands still")
def _(folder: Path) -> Steps:
    drawing()
    yield
    scene().frame_set(scene().frame_current + 7)
