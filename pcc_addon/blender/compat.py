"""What differs between the Blender versions that this add-on supports (4.5 to 5.2), and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack

import bpy

try:
    import _cycles  # inside Blender alone
except ImportError:
    _cycles = None

from ..core.probe import Engine
from . import marks
from .overrides import override

EEVEE_ID = "BLENDER_EEVEE" if bpy.app.version >= (5, 0) else "BLENDER_EEVEE_NEXT"

# From 5.2 on EEVEE draws lamps that cameras may see; before, a capture needs stand-ins.
EEVEE_DRAWS_LAMPS = bpy.app.version >= (5, 2)

# Before 5.0 Cycles shows thin films over dielectrics only.
FILMS_ON_METAL = bpy.app.version >= (5, 0)

# Before 5.2 Cycles has too little memory for a shader with films over a metal and over a dielectric.
FILMS_ON_BOTH = bpy.app.version >= (5, 2)

# Before 5.0 the file of one view of several cannot be read back as a picture.
VIEWS_CAN_BE_READ = bpy.app.version >= (5, 0)

# Cycles' own word for it; distributions build without.
CAN_DENOISE = bool(getattr(_cycles, "with_openimagedenoise", False))


def engine_id(engine: Engine) -> str:
    """The identifier of a render engine in this version."""
    return EEVEE_ID if engine is Engine.EEVEE else "CYCLES"


# In the order in which they must be set: each restricts the values of those behind it.
# Files made before 5.0 ask for interleaved views, and the file of one such view cannot be read back as a picture.
_FORMAT = (
    "media_type",
    "file_format",
    "color_mode",
    "color_depth",
    "exr_codec",
    "color_management",
    "use_exr_interleave",
)
_FLOAT_EXR = ("IMAGE", "OPEN_EXR", "RGB", "32", "ZIP", "FOLLOW_SCENE", False)


def set_float_exr(settings: bpy.types.ImageFormatSettings) -> Callable[[], None]:
    """Make `settings` write 32-bit RGB OpenEXR files; returns what brings the old format back."""
    names = [p.identifier for p in settings.bl_rna.properties if p.type != "POINTER" and not p.is_readonly]
    before = {
        name: getattr(settings, name) for name in sorted(names, key=lambda n: _FORMAT.index(n) if n in _FORMAT else 99)
    }

    def restore() -> None:
        for name, value in before.items():
            if getattr(settings, name) != value:
                setattr(settings, name, value)

    for name, value in zip(_FORMAT, _FLOAT_EXR, strict=True):
        if name in before:
            setattr(settings, name, value)
    return restore


def detach_compositor(stack: ExitStack, scene: bpy.types.Scene) -> None:
    """Part a scene from its compositor until `stack` closes.

    Where denoising is switched on meanwhile, Render Layers nodes of Blender before 5.2 would get a socket for the noisy
    picture and keep it. In 4.5 nothing can part them.
    """
    if bpy.app.version >= (5, 0):
        override(stack, scene, "compositing_node_group", None)


def use_all_inputs(stack: ExitStack, tree: bpy.types.NodeTree) -> None:
    """Let the user's Principled BSDFs in a tree use all their inputs until `stack` closes.

    From 5.2 on whatever comes to a tree or leaves it changes a Principled BSDF whose kind of subsurface scattering
    leaves an input unused; where that BSDF feeds an output, all trees of the file are asked whether they use this one.
    """
    if bpy.app.version < (5, 2):
        return
    for node in tree.nodes:
        known = node.bl_idname == "ShaderNodeBsdfPrincipled" and node.subsurface_method  # "": one of a later Blender
        if known and not marks.role(node):
            override(stack, node, "subsurface_method", "RANDOM_WALK_SKIN")


def uses_nodes(material: bpy.types.Material) -> bool:
    """Whether a material is made of nodes (from 5.0 on every one is)."""
    return material.node_tree is not None and (bpy.app.version >= (5, 0) or material.use_nodes)


def animated_paths(item: bpy.types.ID) -> set[str]:
    """The data paths of an ID that its own keyframes and drivers change."""
    data = item.animation_data
    if data is None:
        return set()
    curves = [*data.drivers]
    for layer in data.action.layers if data.action else ():
        for strip in layer.strips:
            curves += [curve for bag in strip.channelbags for curve in bag.fcurves]
    return {curve.data_path for curve in curves}


def curves_of(item: bpy.types.ID) -> list[bpy.types.FCurve]:
    """The keyframed curves of an ID's own action, and its drivers."""
    data = item.animation_data
    if data is None:
        return []
    found = [*data.drivers]
    for layer in data.action.layers if data.action and data.action_slot else ():
        for strip in layer.strips:
            bag = strip.channelbag(data.action_slot)
            found += bag.fcurves if bag else ()
    return found


def lamp_uses_nodes(lamp: bpy.types.Light) -> bool:
    """Whether a lamp is made of nodes (from 5.2 on every one that has some is)."""
    return lamp.node_tree is not None and (bpy.app.version >= (5, 2) or lamp.use_nodes)


def typed_inputs_and_outputs(modifier: bpy.types.NodesModifier) -> tuple[bpy.types.bpy_struct, ...]:
    """The inputs and outputs of geometry nodes that a modifier sets; none before 5.2, whose are custom properties."""
    if "properties" not in modifier.bl_rna.properties:
        return ()
    return modifier.properties.inputs, modifier.properties.outputs


def world_override(view_layer: bpy.types.ViewLayer) -> bpy.types.World | None:
    """The world that a view layer has instead of the scene's; Blender 4.5 knows none."""
    return getattr(view_layer, "world_override", None)


def working_space() -> str:
    """The colour space that a file's light is computed in; before 5.0 there is one."""
    return bpy.data.colorspace.working_space if hasattr(bpy.data, "colorspace") else "Linear Rec.709"
