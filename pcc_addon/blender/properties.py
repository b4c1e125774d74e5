"""`Object.pcc_probe`: the settings of a probe and the record of its last bake."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ..core.decisions import OF_MATERIALS, OF_PROBES, Effect
from ..core.effects.records import Outside
from ..core.presets import Preset
from ..core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, MOST_SAMPLES, Engine, Source
from . import box_size
from .effect_settings import settings_class

PRESETS = [
    ("NONE", "Usual", "As probes are where nothing is chosen"),
    *((preset.name, preset.label, preset.purpose) for preset in Preset),
]
"""What new probes may be set to, as items of an enumeration."""

shader_listeners: list[Callable[[bpy.types.Object], None]] = []
"""Called with a probe whose settings changed that its shader depends on."""

effect_listeners: list[Callable[[bpy.types.ID, Effect | None], None]] = []
"""Called with a probe or a material for which an artist chose whether an effect is on, and with a material or an object
for which he chose which probes it shows, which is no effect."""


def _refresh_shader(settings: PCC_Probe, context: bpy.types.Context) -> None:
    for listener in shader_listeners:
        listener(settings.id_data)


def _tell_choice(owner: bpy.types.ID, effect: Effect) -> None:
    for listener in effect_listeners:
        listener(owner, effect)


def _tell_shown(settings: PCC_Material | PCC_Object, context: bpy.types.Context) -> None:
    for listener in effect_listeners:
        listener(settings.id_data, None)


def is_probe_here(settings: PCC_Material, item: bpy.types.Object) -> bool:
    """Whether a material can choose an object for the probe that it shows."""
    here = bpy.context.scene.objects.get(item.name) == item
    return here and item.pcc_probe.is_probe and item.library is None


PCC_ProbeEffects = settings_class("PCC_ProbeEffects", OF_PROBES, _tell_choice)
PCC_MaterialEffects = settings_class("PCC_MaterialEffects", OF_MATERIALS, _tell_choice)


class PCC_HiddenObject(bpy.types.PropertyGroup):
    """One object that a capture leaves out."""

    object: bpy.props.PointerProperty(type=bpy.types.Object, name="Object", description="Left out of the capture")


class PCC_BakedLevel(bpy.types.PropertyGroup):
    """One picture of the last bake."""

    roughness: bpy.props.FloatProperty(
        name="Roughness", description="−1: of the picture of how near things are", min=-1.0, max=1.0
    )
    image: bpy.props.PointerProperty(type=bpy.types.Image, name="Picture")


class PCC_Probe(bpy.types.PropertyGroup):
    """A parallax probe. The object's own transform is the box: local [−1, 1]³."""

    is_probe: bpy.props.BoolProperty(name="Parallax Probe", description="This empty is a parallax probe")
    size: bpy.props.FloatVectorProperty(
        name="Size",
        description="Edges of the box along its own axes; the object's scale, in lengths",
        size=3,
        subtype="XYZ_LENGTH",
        unit="LENGTH",
        min=0.0,
        get=box_size.size_of,
        set=box_size.resize,
        options=set(),
    )
    locked: bpy.props.BoolProperty(
        name="Locked",
        description="Bakes of all or of stale probes leave this one as it is; select or name it to bake it",
        options=set(),
    )
    source: bpy.props.EnumProperty(
        name="Source",
        description="Where the probe's pictures come from",
        items=[
            (Source.BAKE.value, "Bake", "Render the scene from the capture point"),
            (Source.IMAGE.value, "Image", "A cubemap from files, stretched to the box and turned with it"),
            (Source.WORLD.value, "World", "The scene's world alone, stretched to the box"),
        ],
    )
    picture: bpy.props.StringProperty(
        name="Picture",
        description="An equirectangular picture, a cross or a strip of six faces, or one of six files whose names end "
        "in their faces (px nx py ny pz nz, right left top bottom front back …)",
        subtype="FILE_PATH",
        options={"ANIMATABLE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    resolution: bpy.props.IntProperty(
        name="Resolution",
        description="Width of one 90° face in pixels; twice as much halves the error and takes four times as long",
        default=512,
        min=MINIMUM_RESOLUTION,
        max=MAXIMUM_RESOLUTION,
        subtype="PIXEL",
    )
    samples: bpy.props.IntProperty(
        name="Samples",
        description="Render samples for each pixel of a face",
        default=64,
        min=1,
        soft_max=4096,
        max=MOST_SAMPLES,
    )
    engine: bpy.props.EnumProperty(
        name="Engine",
        description="Which renderer takes the pictures; both engines can show them",
        items=[
            (Engine.CYCLES.value, "Cycles", "Path-traced lighting"),
            (Engine.EEVEE.value, "EEVEE", "EEVEE's lighting"),
        ],
    )
    denoise: bpy.props.BoolProperty(name="Denoise", description="Denoise the faces of a Cycles bake", default=True)
    adaptive: bpy.props.FloatProperty(
        name="Noise Threshold",
        description="Cycles stops sampling a pixel once its noise is below this, so that it spends its samples where "
        "they are needed; 0: all samples everywhere",
        min=0.0,
        max=1.0,
        soft_max=0.1,
        step=1,
        precision=3,
    )
    capture_offset: bpy.props.FloatVectorProperty(
        name="Capture Offset",
        description="Where the pictures are taken, from the box's centre, or from the object that the probe follows, "
        "along the box's own axes",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
    )
    follow: bpy.props.PointerProperty(
        type=bpy.types.Object,
        name="Follow",
        description="The capture point is at this object's origin instead of the box's centre, and goes with it; the "
        "object and its children are left out of the capture, but lamps among these are not",
    )
    clip_start: bpy.props.FloatProperty(
        name="Clip Start", description="Nearest distance that is captured", default=0.01, min=1e-6, unit="LENGTH"
    )
    clip_end: bpy.props.FloatProperty(
        name="Clip End", description="Farthest distance that is captured", default=1000.0, min=1e-5, unit="LENGTH"
    )
    padding: bpy.props.FloatProperty(
        name="Padding",
        description="How far outside the box a surface still shows the corrected reflection",
        default=0.01,
        min=0.0,
        soft_max=1.0,
        unit="LENGTH",
        update=_refresh_shader,
    )
    falloff: bpy.props.FloatProperty(
        name="Falloff",
        description="Over which distance beyond the padding the corrected reflection fades out",
        default=0.25,
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
        update=_refresh_shader,
    )
    influence_low: bpy.props.FloatVectorProperty(
        name="Influence Low",
        description="How far the influence reaches beyond the box's faces at its own −X, −Y and −Z; negative: stays "
        "short of them",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        soft_min=-10.0,
        soft_max=10.0,
        update=_refresh_shader,
    )
    influence_high: bpy.props.FloatVectorProperty(
        name="Influence High",
        description="How far the influence reaches beyond the box's faces at its own +X, +Y and +Z; negative: stays "
        "short of them",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        soft_min=-10.0,
        soft_max=10.0,
        update=_refresh_shader,
    )
    falloff_per_face: bpy.props.BoolProperty(
        name="Falloff per Face",
        description="Let the reflection fade over another distance beyond each face",
        update=_refresh_shader,
    )
    falloff_low: bpy.props.FloatVectorProperty(
        name="Falloff Low",
        description="Over which distance the reflection fades beyond the faces at the box's own −X, −Y and −Z",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        default=(0.25, 0.25, 0.25),
        min=0.0,
        soft_max=10.0,
        update=_refresh_shader,
    )
    falloff_high: bpy.props.FloatVectorProperty(
        name="Falloff High",
        description="Over which distance the reflection fades beyond the faces at the box's own +X, +Y and +Z",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        default=(0.25, 0.25, 0.25),
        min=0.0,
        soft_max=10.0,
        update=_refresh_shader,
    )
    normal_fade: bpy.props.FloatProperty(
        name="Normal Fade",
        description="How deep below the border of the influence surfaces that face away from the capture point fade "
        "to their own reflection; 0: none do",
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
        update=_refresh_shader,
    )
    weight: bpy.props.FloatProperty(
        name="Weight",
        description="How much of the reflection is the probe's where nothing fades; the rest is the surface's own",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_refresh_shader,
    )
    priority: bpy.props.IntProperty(
        name="Priority",
        description="Where boxes overlap the probe with the higher priority is shown; of equal ones the smaller box, "
        "then the nearer. Counts from the next injection",
        soft_min=-10,
        soft_max=10,
    )
    receivers: bpy.props.PointerProperty(
        type=bpy.types.Collection,
        name="Receivers",
        description="Only its objects show the probe; empty: all objects in its influence do. Counts from the next "
        "injection",
    )
    excluded: bpy.props.PointerProperty(
        type=bpy.types.Collection,
        name="Excluded",
        description="Its objects do not show the probe. Counts from the next injection",
    )
    outside: bpy.props.EnumProperty(
        name="Outside",
        description="What a surface outside the box shows",
        items=[
            (Outside.OWN.value, "Own", "Fade to what the material reflects without probes", 2),
            (Outside.UNCORRECTED.value, "Uncorrected", "Fade to the reflection without parallax correction", 0),
            (Outside.BLACK.value, "Black", "Fade to no reflection", 1),
        ],
        default=Outside.OWN.value,
        update=_refresh_shader,
    )
    correction: bpy.props.EnumProperty(
        name="Correction",
        description="How a reflection finds its place in the picture",
        items=[
            ("BOX", "Box", "Parallax-corrected by the probe's box", 0),
            (
                "RELIEF",
                "Relief",
                "Parallax-corrected by the probe's box and by what stands in it: bakes capture distances too, and rays "
                "are followed through them. Where all that is seen lies on the box it is the same as Box",
                2,
            ),
            ("NONE", "None", "The classic lookup, right only for things far away", 1),
        ],
        update=_refresh_shader,
    )
    relief_steps: bpy.props.IntProperty(
        name="Relief Steps",
        description="At how many places on its way to the wall a ray is looked at: with more, thinner things are "
        "found, and frames take longer",
        default=12,
        min=2,
        max=64,
        update=_refresh_shader,
    )
    relief_refinements: bpy.props.IntProperty(
        name="Refinements",
        description="How often the step in which a ray meets something is halved: each one more doubles the precision",
        default=4,
        min=0,
        max=16,
        update=_refresh_shader,
    )
    half_float: bpy.props.BoolProperty(
        name="Half Float",
        description="Keep the pictures in half precision: half the space, and three digits, which noise hides. "
        "Radiances above 65504 are cut off",
    )
    contact_hardening: bpy.props.BoolProperty(
        name="Contact Hardening",
        description="Rough surfaces reflect the sharper what is nearer to them on the box's walls. Reads more levels "
        "of the picture, so it takes longer to render; mirrors stay as they are",
        update=_refresh_shader,
    )
    hidden_objects: bpy.props.CollectionProperty(type=PCC_HiddenObject)
    hidden_collection: bpy.props.PointerProperty(
        type=bpy.types.Collection,
        name="Hidden Collection",
        description="Its objects are left out of the capture, such as the mirror ball that stands at the capture point",
    )
    effects: bpy.props.PointerProperty(type=PCC_ProbeEffects)
    uid: bpy.props.StringProperty(options={"HIDDEN"})
    group: bpy.props.PointerProperty(type=bpy.types.NodeTree)
    levels: bpy.props.CollectionProperty(type=PCC_BakedLevel)
    advice: bpy.props.StringProperty(
        name="Advice",
        description="What the last measurement of costs recommends instead of this probe; empty: nothing",
        options={"HIDDEN"},
    )
    bake_record: bpy.props.StringProperty(options={"HIDDEN"}, description="The sidecar of the last bake")


class PCC_Material(bpy.types.PropertyGroup):
    """How a material shows probes."""

    effects: bpy.props.PointerProperty(type=PCC_MaterialEffects)
    show_probes: bpy.props.BoolProperty(
        name="Show Probes",
        description="Let the material show the probes that its objects are in; off: it keeps its own reflections",
        default=True,
        options=set(),
        update=_tell_shown,
    )
    probe: bpy.props.PointerProperty(
        type=bpy.types.Object,
        name="Probe",
        description="This probe alone serves the material, wherever its influence reaches; empty: whichever probes "
        "its objects are in",
        poll=is_probe_here,
        update=_tell_shown,
    )


class PCC_Object(bpy.types.PropertyGroup):
    """Whether an object shows probes."""

    show_probes: bpy.props.BoolProperty(
        name="Show Probes",
        description="Let the object's materials show the probes that it is in; off: they keep their own reflections "
        "on this object, and go on showing probes on others",
        default=True,
        options=set(),
        update=_tell_shown,
    )


class PCC_Scene(bpy.types.PropertyGroup):
    """Where a scene's bakes go, and which materials show them."""

    roughness_limit: bpy.props.FloatProperty(
        name="Roughness Limit",
        description="Rougher surfaces keep their own reflections: what they reflect is mostly near them, where one "
        "capture point does not see who shades whom",
        default=0.6,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )

    folder: bpy.props.StringProperty(
        name="Folder",
        description="Where the pictures are written; empty: a folder beside the .blend, named after it",
        subtype="DIR_PATH",
    )

    preset: bpy.props.EnumProperty(
        name="Preset",
        description="What probes that are added in the window are set to",
        items=PRESETS,
    )


CLASSES = (
    PCC_ProbeEffects,
    PCC_MaterialEffects,
    PCC_HiddenObject,
    PCC_BakedLevel,
    PCC_Probe,
    PCC_Material,
    PCC_Object,
    PCC_Scene,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.pcc_probe = bpy.props.PointerProperty(type=PCC_Probe)
    bpy.types.Object.pcc = bpy.props.PointerProperty(type=PCC_Object)
    bpy.types.Material.pcc = bpy.props.PointerProperty(type=PCC_Material)
    bpy.types.Scene.pcc = bpy.props.PointerProperty(type=PCC_Scene)


def unregister() -> None:
    del bpy.types.Scene.pcc
    del bpy.types.Material.pcc
    del bpy.types.Object.pcc
    del bpy.types.Object.pcc_probe
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
