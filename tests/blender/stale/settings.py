"""Settings of the scene, of the probe, and other probes."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.stale.rows import Steps, fresh, settings_rows, stale
from tests.blender.stale.things import (
    background,
    collection,
    instances,
    material,
    placed,
    probe,
    scene,
    surface,
    the,
    thing,
    tree,
    world,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE

settings_rows(
    True, "scene, Cycles", lambda: scene().cycles, "{}", CYCLES, max_bounces=5, diffuse_bounces=1, glossy_bounces=1,
    transmission_bounces=1, volume_bounces=3, transparent_max_bounces=3, sample_clamp_direct=1.0,
    sample_clamp_indirect=3.0, caustics_reflective=False, caustics_refractive=False, blur_glossy=0.5, use_fast_gi=True,
    volume_step_rate=2.0, volume_max_steps=100,
)  # fmt: skip


@stale("scene, Cycles", "the distance of fast global illumination")
def _(folder: Path) -> Steps:
    scene().cycles.use_fast_gi = True
    yield
    world().light_settings.distance = 3.0


@stale("scene, Cycles", "the seed, where nothing is denoised", denoise=False)
def _(folder: Path) -> Steps:
    yield
    scene().cycles.seed = 7


@stale("scene, Cycles", "the denoiser's input, where pictures are denoised", denoise=True)
def _(folder: Path) -> Steps:
    yield
    scene().cycles.denoising_input_passes = "RGB"


@stale("scene, Cycles", "simplified subdivision")
def _(folder: Path) -> Steps:
    scene().render.use_simplify = True
    yield
    scene().render.simplify_subdivision_render = 1


@stale("scene, Cycles", "simplified at all")
def _(folder: Path) -> Steps:
    yield
    scene().render.use_simplify = True


@stale("scene, Cycles", "a material for all")
def _(folder: Path) -> Steps:
    other = material().copy()
    other.displacement_method = "BOTH"
    yield
    bpy.context.view_layer.material_override = other


@stale("scene, Cycles", "a set in the background")
def _(folder: Path) -> Steps:
    other = bpy.data.scenes.new("Set")
    other.collection.objects.link(thing("Prop", link=False))
    yield
    scene().background_set = other


settings_rows(
    True, "scene, EEVEE", lambda: scene().eevee, "{}", EEVEE, use_shadows=False, shadow_ray_count=3,
    shadow_step_count=3, use_raytracing=True, use_fast_gi=False, fast_gi_distance=1.0, light_threshold=0.2,
    clamp_surface_indirect=2.0, volumetric_end=20.0, use_volumetric_shadows=True,
)  # fmt: skip
settings_rows(
    True, "scene, EEVEE", lambda: scene().eevee.ray_tracing_options, "ray tracing: {}", EEVEE, trace_max_roughness=0.1,
    resolution_scale="4",
)  # fmt: skip


settings_rows(
    False, "scene", lambda: scene().render, "{}", CYCLES, resolution_x=123, resolution_percentage=50,
    filepath="//other", use_motion_blur=True, film_transparent=True, use_border=True, threads=3, threads_mode="FIXED",
    use_stamp=True, simplify_subdivision_render=1,
)  # fmt: skip
settings_rows(
    False, "scene", lambda: scene().cycles, "{}", CYCLES, samples=7, preview_samples=7, use_adaptive_sampling=True,
    film_exposure=2.0, pixel_filter_type="GAUSSIAN", tile_size=512, use_denoising=True, time_limit=3.0,
)  # fmt: skip
settings_rows(
    False, "scene", lambda: scene().eevee, "{}, which is EEVEE's", CYCLES, use_shadows=False, use_raytracing=True
)
settings_rows(False, "scene", lambda: scene().eevee, "{}", EEVEE, taa_render_samples=7, taa_samples=7)
settings_rows(False, "scene", lambda: scene().cycles, "{}, which is Cycles'", EEVEE, max_bounces=5, seed=4)
settings_rows(False, "scene", lambda: scene().view_settings, "view: {}", CYCLES, exposure=1.0, gamma=2.0)


@fresh("scene", "the seed, where pictures are denoised", denoise=True)
def _(folder: Path) -> Steps:
    yield
    scene().cycles.seed = 7


@fresh("scene", "how it is shown")
def _(folder: Path) -> Steps:
    yield
    scene().view_settings.view_transform = "Raw"


@fresh("scene", "the camera moved")
def _(folder: Path) -> Steps:
    camera = placed("Camera", bpy.data.cameras.new("Camera"))
    scene().camera = camera
    yield
    camera.location.x = 3.0


@fresh("scene", "another camera")
def _(folder: Path) -> Steps:
    yield
    scene().camera = placed("Camera", bpy.data.cameras.new("Camera"))


@fresh("scene", "a marker")
def _(folder: Path) -> Steps:
    yield
    scene().timeline_markers.new("Here", frame=3)


@fresh("scene", "an edit of another scene")
def _(folder: Path) -> Steps:
    other = bpy.data.scenes.new("Other")
    yield
    other.collection.objects.link(thing("Elsewhere", link=False))
    other.cycles.max_bounces = 3


@fresh("scene", "an empty")
def _(folder: Path) -> Steps:
    yield
    placed("Empty", None)


@fresh("scene", "the order of collections and objects")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.location.x = 3.0
    first, _ = collection("First", the()), collection("Second", other)
    yield
    scene().collection.children.unlink(first)
    scene().collection.children.link(first)


settings_rows(
    True, "probe", probe, "{}", CYCLES, resolution=64, samples=3, denoise=False, engine="EEVEE", clip_start=0.5,
    clip_end=50.0, capture_offset=(0.1, 0.0, 0.0),
)  # fmt: skip


@stale("probe", "moved")
def _(folder: Path) -> Steps:
    yield
    the("Probe").location.x += 0.1


@stale("probe", "an object hidden from it")
def _(folder: Path) -> Steps:
    yield
    probe().hidden_objects.add().object = the()


@stale("probe", "a collection hidden from it")
def _(folder: Path) -> Steps:
    made = collection("Some", the())
    yield
    probe().hidden_collection = made


@stale("probe", "an instanced object hidden from it")
def _(folder: Path) -> Steps:
    instances(the())
    yield
    probe().hidden_objects.add().object = the()


settings_rows(
    False, "probe", probe, "{}", CYCLES, padding=0.5, falloff=0.5, outside="UNCORRECTED", correction="NONE", weight=0.5,
    priority=3, normal_fade=0.1, influence_low=(0.1, 0.1, 0.1), contact_hardening=True,
)  # fmt: skip


@fresh("probe", "its box alone")
def _(folder: Path) -> Steps:
    yield
    the("Probe").scale.x *= 1.5


@fresh("probe", "its name")
def _(folder: Path) -> Steps:
    yield
    the("Probe").name = "Renamed"


@fresh("probe", "an edit of what is hidden from it")
def _(folder: Path) -> Steps:
    probe().hidden_objects.add().object = the()
    yield
    the().location.x = 3.0
    the().data.vertices[0].co.x = 2.0


@fresh("probe", "the name of what is hidden from it")
def _(folder: Path) -> Steps:
    probe().hidden_objects.add().object = the()
    yield
    the().name = "Renamed"


@fresh("other probes", "another one, baked")
def _(folder: Path) -> Steps:
    yield
    pretend_bake(small_probe("Other"))


@fresh("other probes", "injected into materials")
def _(folder: Path) -> Steps:
    surface().inputs["Roughness"].default_value = 0.0
    pretend_bake(the("Probe"))
    yield
    assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}
    assert any(n.get("parallax_probes") for n in tree().nodes)


@fresh("other probes", "removed from materials")
def _(folder: Path) -> Steps:
    surface().inputs["Roughness"].default_value = 0.0
    pretend_bake(the("Probe"))
    assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}
    yield
    assert bpy.ops.pcc.remove(scope="SCENE") == {"FINISHED"}


@fresh("other probes", "injected where each engine has an output", EEVEE)
def _(folder: Path) -> Steps:
    surface().inputs["Roughness"].default_value = 0.0
    output = next(n for n in tree().nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    output.target = "CYCLES"
    other, second = tree().nodes.new("ShaderNodeOutputMaterial"), tree().nodes.new("ShaderNodeBsdfPrincipled")
    other.target = "EEVEE"
    second.inputs["Roughness"].default_value = 0.2
    tree().links.new(second.outputs[0], other.inputs["Surface"])
    pretend_bake(the("Probe"))
    yield
    assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}


@fresh("world", "names and places of its nodes")
def _(folder: Path) -> Steps:
    yield
    background().name, background().location = "Renamed", (100.0, 100.0)
