"""Settings of a scene and its view layer that change what an engine's capture shows; what the capture sets is none."""

from __future__ import annotations

import bpy

from ... import compat
from .digests import digest, plain
from .properties import named, settings

# What changes the light, and not how it is sampled.
_CYCLES = (
    "max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces",
    "transparent_max_bounces", "sample_clamp_direct", "sample_clamp_indirect", "caustics_reflective",
    "caustics_refractive", "blur_glossy", "use_fast_gi", "volume_step_rate", "volume_max_steps", "volume_biased",
    "max_subdivisions", "dicing_rate", "offscreen_dicing_scale", "shading_system", "use_pixel_jitter",
    "use_layer_samples", "feature_set",
)  # fmt: skip
_FAST_GI = ("fast_gi_method", "ao_bounces_render")
# Noise alone: another picture only where no denoiser takes it away.
_NOISE = (
    "seed", "sampling_pattern", "scrambling_distance", "auto_scrambling_distance", "light_sampling_threshold",
    "direct_light_sampling_type", "use_light_tree", "min_light_bounces", "min_transparent_bounces", "use_guiding",
    "use_sample_subset", "sample_offset", "sample_subset_length",
)  # fmt: skip
_DENOISER = ("denoiser", "denoising_prefilter", "denoising_quality", "denoising_input_passes")
_SIMPLIFY = ("simplify_subdivision_render", "simplify_child_particles_render", "simplify_volumes")
_SIMPLIFY_CYCLES = (
    "use_camera_cull", "camera_cull_margin", "use_distance_cull", "distance_cull_margin", "texture_limit_render",
    "texture_resolution_render",
)  # fmt: skip
_LAYER = ("use_sky", "use_solid", "use_strand", "use_volumes", "use_ao", "use_grease_pencil")
# Of EEVEE's settings: what captures set, what viewports obey, and what cameras and moving things alone have.
_NOT_EEVEE = frozenset(
    {
        "taa_samples",
        "taa_render_samples",
        "use_taa_reprojection",
        "use_shadow_jitter_viewport",
        "gi_irradiance_pool_size",
    }
    | {"shadow_pool_size", "use_overscan", "overscan_size", "bokeh_max_size", "bokeh_threshold", "bokeh_neighbor_max"}
    | {"use_bokeh_jittered", "bokeh_overblur", "motion_blur_depth_scale", "motion_blur_max", "motion_blur_steps"}
)


def of_scene(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, is_eevee: bool, is_denoised: bool) -> bytes:
    """A digest of the settings that an engine obeys."""
    render = scene.render
    parts = [named(view_layer, _LAYER), plain(compat.working_space()), plain(render.use_simplify)]
    if render.use_simplify:
        parts.append(named(render, _SIMPLIFY))
    if is_eevee:
        parts.append(settings(scene.eevee, lambda *_: b"", set(), _NOT_EEVEE))
        parts.append(named(render, ("use_high_quality_normals", "hair_type", "hair_subdiv")))
        return digest(*parts)
    cycles = scene.cycles
    parts += [named(cycles, _CYCLES), named(scene.cycles_curves, ("shape", "subdivisions"))]
    if render.use_simplify:
        parts.append(named(cycles, _SIMPLIFY_CYCLES))
    if cycles.use_fast_gi:
        light = scene.world.light_settings if scene.world else None
        parts += [named(cycles, _FAST_GI), named(light, ("ao_factor", "distance"))]
    if cycles.use_layer_samples != "IGNORE":
        parts.append(plain(view_layer.samples))
    if is_denoised:
        parts += [named(cycles, _DENOISER), plain(view_layer.cycles.use_denoising)]
    else:
        parts.append(named(cycles, _NOISE))
    return digest(*parts)
