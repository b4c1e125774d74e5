"""What meshes are made of."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, stale
from tests.blender.stale.things import (
    node,
    the,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@stale("mesh", "a vertex moved")
def _(folder: Path) -> Steps:
    yield
    the().data.vertices[0].co.x += 1e-4


@stale("mesh", "a vertex moved in edit mode")
def _(folder: Path) -> Steps:
    import bmesh

    bpy.context.view_layer.objects.active = the()
    bpy.ops.object.mode_set(mode="EDIT")
    yield
    made = bmesh.from_edit_mesh(the().data)
    made.verts.ensure_lookup_table()
    made.verts[0].co.x += 0.1
    bmesh.update_edit_mesh(the().data)


@stale("mesh", "a UV moved")
def _(folder: Path) -> Steps:
    yield
    the().data.uv_layers[0].uv[3].vector.x += 0.1


@stale("mesh", "another UV map is the one that renders read")
def _(folder: Path) -> Steps:
    second = the().data.uv_layers.new(name="Second")
    for corner in second.uv:
        corner.vector = (0.5, 0.5)
    the().data.uv_layers["UV"].active_render = True
    yield
    the().data.uv_layers["Second"].active_render = True


@stale("mesh", "a UV map renamed that a shader reads by name")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeUVMap")
    made.uv_map = "UV"
    yield
    the().data.uv_layers[0].name = "Other"


@stale("mesh", "a UV map renamed that a modifier reads by name")
def _(folder: Path) -> Steps:
    the().modifiers.new("Warp", "UV_WARP").uv_layer = "UV"
    yield
    the().data.uv_layers[0].name = "Other"
    the().modifiers[0].uv_layer = "UV"


@stale("mesh", "a vertex colour")
def _(folder: Path) -> Steps:
    colors = the().data.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    yield
    colors.data[2].color = (0.25, 0.5, 0.75, 1.0)


@stale("mesh", "an attribute's number")
def _(folder: Path) -> Steps:
    made = the().data.attributes.new("Wet", "FLOAT", "POINT")
    yield
    made.data[2].value = 0.5


@stale("mesh", "a face's material")
def _(folder: Path) -> Steps:
    the().data.materials.append(bpy.data.materials.new("Second"))
    yield
    the().data.polygons[2].material_index = 1


@stale("mesh", "a face flat instead of smooth")
def _(folder: Path) -> Steps:
    the().data.polygons[0].use_smooth = True
    yield
    the().data.polygons[0].use_smooth = False


@stale("mesh", "a sharp edge")
def _(folder: Path) -> Steps:
    yield
    the().data.edges[0].use_edge_sharp = True


@stale("mesh", "a custom normal")
def _(folder: Path) -> Steps:
    the().data.normals_split_custom_set([(0.0, 0.0, 1.0)] * 24)
    yield
    the().data.normals_split_custom_set([(0.0, 0.6, 0.8)] * 24)


@stale("mesh", "a face less")
def _(folder: Path) -> Steps:
    import bmesh

    yield
    made = bmesh.new()
    made.from_mesh(the().data)
    made.faces.ensure_lookup_table()
    made.faces.remove(made.faces[0])
    made.to_mesh(the().data)


@stale("mesh", "another mesh")
def _(folder: Path) -> Steps:
    other = the().data.copy()
    other.vertices[0].co.x += 1.0
    yield
    the().data = other


@stale("mesh", "the space of generated coordinates")
def _(folder: Path) -> Steps:
    the().data.use_auto_texspace = False
    yield
    the().data.texspace_size = (2.0, 1.0, 1.0)
