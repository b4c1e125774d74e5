"""Materials, from the outputs back."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, fresh, settings_rows, stale
from tests.blender.stale.things import (
    group,
    material,
    node,
    surface,
    the,
    tree,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@stale("material", "a value")
def _(folder: Path) -> Steps:
    yield
    surface().inputs["Roughness"].default_value += 0.001


@stale("material", "a node and its link")
def _(folder: Path) -> Steps:
    yield
    node("ShaderNodeTexNoise")


@stale("material", "a link cut")
def _(folder: Path) -> Steps:
    node("ShaderNodeTexNoise")
    yield
    tree().links.remove(surface().inputs["Base Color"].links[0])


@stale("material", "a link muted")
def _(folder: Path) -> Steps:
    node("ShaderNodeTexNoise")
    yield
    surface().inputs["Base Color"].links[0].is_muted = True


@stale("material", "a link to another output of a node")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeTexVoronoi", "Color")
    yield
    tree().links.new(made.outputs["Distance"], surface().inputs["Base Color"])


@stale("material", "two links exchanged")
def _(folder: Path) -> Steps:
    noise, mix = tree().nodes.new("ShaderNodeTexNoise"), node("ShaderNodeMath")
    mix.operation = "SUBTRACT"
    wave = tree().nodes.new("ShaderNodeTexWave")
    tree().links.new(noise.outputs[0], mix.inputs[0]), tree().links.new(wave.outputs[0], mix.inputs[1])
    yield
    tree().links.new(wave.outputs[0], mix.inputs[0]), tree().links.new(noise.outputs[0], mix.inputs[1])


@stale("material", "a node muted")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeGamma")
    made.inputs["Gamma"].default_value = 2.0
    yield
    made.mute = True


@stale("material", "a value before a muted node")
def _(folder: Path) -> Steps:
    made, before = node("ShaderNodeGamma"), tree().nodes.new("ShaderNodeRGB")
    tree().links.new(before.outputs[0], made.inputs["Color"])
    made.mute = True
    yield
    before.outputs[0].default_value = (1.0, 0.0, 0.0, 1.0)


@stale("material", "a setting of a node")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeMath")
    yield
    made.operation = "MULTIPLY"


@stale("material", "a colour ramp")
def _(folder: Path) -> Steps:
    ramp = node("ShaderNodeValToRGB")
    yield
    ramp.color_ramp.elements[0].color = (1.0, 0.0, 0.0, 1.0)


@stale("material", "a curve")
def _(folder: Path) -> Steps:
    curve = node("ShaderNodeRGBCurve")
    yield
    curve.mapping.curves[3].points[0].location = (0.0, 0.25)


@stale("material", "a Value node")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeValue")
    yield
    made.outputs[0].default_value = 0.25


@stale("material", "a value behind reroutes")
def _(folder: Path) -> Steps:
    made, source = node("NodeReroute"), tree().nodes.new("ShaderNodeValue")
    tree().links.new(source.outputs[0], made.inputs[0])
    yield
    source.outputs[0].default_value = 0.25


@stale("material", "a value within a group")
def _(folder: Path) -> Steps:
    inner = group()
    yield
    inner.nodes["Brightness/Contrast"].inputs["Bright"].default_value = 0.5


@stale("material", "an input of a group")
def _(folder: Path) -> Steps:
    group()
    made = next(n for n in tree().nodes if n.bl_idname == "ShaderNodeGroup")
    yield
    made.inputs[0].default_value = (1.0, 0.0, 0.0, 1.0)


@stale("material", "what feeds a group")
def _(folder: Path) -> Steps:
    group()
    made, source = (tree().nodes.new("ShaderNodeRGB") for _ in range(2))
    user = next(n for n in tree().nodes if n.bl_idname == "ShaderNodeGroup")
    source.outputs[0].default_value = (1.0, 0.0, 0.0, 1.0)
    tree().links.new(made.outputs[0], user.inputs[0])
    yield
    tree().links.new(source.outputs[0], user.inputs[0])


@stale("material", "another output of the user's")
def _(folder: Path) -> Steps:
    other, glow = tree().nodes.new("ShaderNodeOutputMaterial"), tree().nodes.new("ShaderNodeEmission")
    tree().links.new(glow.outputs[0], other.inputs["Surface"])
    next(n for n in tree().nodes if n.bl_idname == "ShaderNodeOutputMaterial").is_active_output = True
    yield
    other.is_active_output = True


@stale("material", "a text that a shader reads")
def _(folder: Path) -> Steps:
    made, text = node("ShaderNodeTexIES", 0, "Roughness"), bpy.data.texts.new("Lamp")
    made.ies = text
    yield
    text.write("IESNA:LM-63-2002")


@stale("material", "a file that a shader reads")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeTexIES", 0, "Roughness")
    made.mode, made.filepath = "EXTERNAL", str(folder / "lamp.ies")
    yield
    (folder / "lamp.ies").write_text("IESNA:LM-63-2002")


@stale("material", "displacement")
def _(folder: Path) -> Steps:
    made = tree().nodes.new("ShaderNodeDisplacement")
    output = next(n for n in tree().nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree().links.new(made.outputs[0], output.inputs["Displacement"])
    yield
    made.inputs["Height"].default_value = 0.25


@stale("material", "how it is displaced")
def _(folder: Path) -> Steps:
    yield
    material().displacement_method = "BOTH"


settings_rows(
    True, "material", material, "{}", EEVEE, use_backface_culling=True, surface_render_method="BLENDED",
    use_transparent_shadow=False, use_raytrace_refraction=True, thickness_mode="SLAB",
)  # fmt: skip


@fresh("material", "places, labels, colours and frames of nodes")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeTexNoise")
    yield
    frame = tree().nodes.new("NodeFrame")
    made.parent, made.label, made.hide, made.select = frame, "Mine", True, False
    made.location, made.use_custom_color, made.color = (500.0, 100.0), True, (1.0, 0.0, 0.0)
    tree().nodes.active = made


@fresh("material", "a reroute in a link")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeTexNoise")
    yield
    reroute = node("NodeReroute")
    tree().links.new(made.outputs[0], reroute.inputs[0])


@fresh("material", "nodes that reach no output")
def _(folder: Path) -> Steps:
    yield
    made, other = tree().nodes.new("ShaderNodeTexNoise"), tree().nodes.new("ShaderNodeGamma")
    tree().links.new(made.outputs[0], other.inputs[0])
    made.inputs["Scale"].default_value = 7.0


@fresh("material", "a value that a link stands over")
def _(folder: Path) -> Steps:
    node("ShaderNodeTexNoise")
    yield
    surface().inputs["Base Color"].default_value = (1.0, 0.0, 0.0, 1.0)


@fresh("material", "an input of a group that reaches no output of it")
def _(folder: Path) -> Steps:
    inner = group()
    inner.interface.new_socket("Unused", in_out="INPUT", socket_type="NodeSocketFloat")
    made = next(n for n in tree().nodes if n.bl_idname == "ShaderNodeGroup")
    yield
    made.inputs["Unused"].default_value = 0.5


@fresh("material", "the order in which nodes were made")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeTexNoise")
    yield
    tree().nodes.remove(made)
    tree().nodes.new("ShaderNodeGamma")
    node("ShaderNodeTexNoise")


@fresh("material", "one that nobody shows")
def _(folder: Path) -> Steps:
    other = material().copy()
    yield
    other.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9


@fresh("material", "one in a slot that no face asks for")
def _(folder: Path) -> Steps:
    other = material().copy()
    the().data.materials.append(other)
    yield
    other.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9


@fresh("material", "another one that is the same")
def _(folder: Path) -> Steps:
    yield
    the().material_slots[0].material = material().copy()


@fresh("material", "its colour in viewports, its preview and pass index")
def _(folder: Path) -> Steps:
    yield
    material().diffuse_color, material().pass_index = (1.0, 0.0, 0.0, 1.0), 5
    material().preview_render_type = "CUBE"


settings_rows(
    False, "material", material, "{}, which is EEVEE's", CYCLES, use_backface_culling=True,
    surface_render_method="BLENDED",
)  # fmt: skip
