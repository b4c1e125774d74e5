"""Which tests hold which module, the fastest first. Modules whose tests start other processes cannot be tried."""

from __future__ import annotations

_PLAN = ("tests/core/test_plan.py", "tests/core/test_plan_report.py")
_REFLECTANCE = ("tests/core/test_reflectance.py",)
_LOBES = ("tests/core/test_plan.py", *_REFLECTANCE)
_TWINS = ("tests/blender/test_twin_nodes.py", "tests/blender/test_live.py")
_GROUPS = ("tests/blender/test_probe_group.py", "tests/blender/test_drivers.py", "tests/blender/test_live.py")
_MATERIALS = ("tests/blender/test_read_materials.py", "tests/blender/test_twin_refused.py")

SUITES: dict[str, tuple[str, ...]] = {
    "core/belonging.py": ("tests/core/test_belonging.py", *_PLAN),
    "core/plan.py": _PLAN,
    "core/plan_report.py": ("tests/core/test_plan_report.py",),
    "core/pictures.py": ("tests/core/test_pictures.py", "tests/core/test_plan.py", "tests/core/test_sidecar.py"),
    "core/probe.py": ("tests/core/test_probe.py", "tests/core/test_formula.py", "tests/core/test_stretched.py"),
    "core/layouts.py": ("tests/core/test_layouts.py",),
    "core/picture_files.py": ("tests/core/test_picture_files.py",),
    "core/readings.py": _PLAN,
    "core/effects/choice.py": ("tests/core/test_coverage.py",),
    "core/effects/dielectric.py": _LOBES,
    "core/effects/fresnel.py": _REFLECTANCE,
    "core/effects/glossy.py": _LOBES,
    "core/effects/interior.py": ("tests/core/test_interior.py",),
    "core/effects/kinds.py": _PLAN,
    "core/effects/lobe.py": _REFLECTANCE,
    "core/effects/lookup.py": (
        "tests/core/test_lookup.py",
        "tests/core/test_formula.py",
        "tests/core/test_stretched.py",
        "tests/core/test_coverage.py",
        "tests/core/test_probe.py",
    ),
    "core/effects/metal.py": _LOBES,
    "core/effects/multiscatter.py": _LOBES,
    "core/effects/records.py": (
        "tests/core/test_lookup.py",
        "tests/core/test_probe.py",
        "tests/core/test_formula.py",
        "tests/core/test_plan.py",
    ),
    "core/effects/roughness.py": ("tests/core/test_roughness.py",),
    "core/effects/surface.py": _LOBES,
    "core/cubemap.py": ("tests/core/test_cubemap.py",),
    "core/equirect.py": ("tests/core/test_equirect.py", "tests/core/test_seams.py"),
    "core/expression.py": ("tests/core/test_expression.py", "tests/core/test_formula.py"),
    "core/flat.py": ("tests/core/test_interior.py",),
    "core/room_map.py": ("tests/core/test_window.py",),
    "core/window.py": ("tests/core/test_window.py",),
    "core/ggx.py": ("tests/core/test_ggx.py", "tests/core/test_prefilter.py"),
    "core/prefilter.py": ("tests/core/test_prefilter.py",),
    "core/radiance.py": ("tests/core/test_radiance.py",),
    "core/sidecar.py": ("tests/core/test_sidecar.py",),
    "blender/bake/environment.py": ("tests/blender/test_any_cubemap.py",),
    "blender/read/fingerprint.py": ("tests/blender/test_fingerprint.py", "tests/blender/test_any_cubemap.py"),
    "blender/read/materials.py": _MATERIALS,
    "blender/read/nodes.py": _MATERIALS,
    "blender/read/probes.py": ("tests/blender/test_read_probes.py", "tests/blender/test_probe_add.py"),
    "blender/read/scene.py": ("tests/blender/test_read_scene.py",),
    "blender/handlers.py": ("tests/blender/test_handlers.py", "tests/blender/test_live.py"),
    "blender/marks.py": ("tests/blender/test_marks.py",),
    "blender/shade/built.py": _GROUPS[:1],
    "blender/shade/drivers.py": ("tests/blender/test_drivers.py",),
    "blender/shade/groups.py": _TWINS,
    "blender/shade/injection.py": ("tests/blender/test_injection.py", *_TWINS),
    "blender/shade/interior.py": ("tests/blender/test_interior.py",),
    "blender/shade/live.py": _TWINS[::-1],
    "blender/shade/node_builder.py": ("tests/blender/test_emitted_nodes.py", "tests/blender/test_node_builder.py"),
    "blender/shade/probe_group.py": _GROUPS,
    "blender/shade/twin.py": (*_TWINS, "tests/blender/test_twin_tampered.py"),
    "blender/shade/sketch.py": _TWINS,
    "blender/shade/surface_builder.py": _TWINS,
    "blender/shade/twin_builder.py": _TWINS,
    "blender/status.py": ("tests/blender/test_status.py",),
    "blender/store/image_files.py": ("tests/blender/test_any_cubemap.py",),
    "blender/store/levels.py": ("tests/blender/test_levels.py",),
    "blender/store/pictures.py": ("tests/blender/test_pictures.py", "tests/blender/test_levels.py"),
}
