"""Writing what a cost run recommends into a probe, and where its results go."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...core.accuracy.advice import Advice, Winner
from ...core.accuracy.records import CostReport
from ...core.errors import PccError
from ..fitting import FitJob, apply_fit
from ..read.probes import named_probes
from .bench import apply
from .partner import partner_of


def results_folder(blend: Path) -> Path:
    """A folder beside a .blend, named after it."""
    return blend.with_suffix(".cost")


def _fit(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probe: bpy.types.Object) -> None:
    [result] = FitJob(scene, view_layer, [probe]).run()
    if result.fit is None:
        raise PccError(result.error)
    apply_fit(probe, result.fit, view_layer)


def apply_to(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, report: CostReport, found: Advice
) -> bpy.types.Object:
    """Write the recommended settings into the probe that was measured, and into the one that shares the room where both
    are recommended; their bakes are out of date then.

    Where path tracing wins the probe remembers why, and the plan says so.

    Args:
        scene, view_layer: that have the probe.
        report: what was measured.
        found: what follows from it; something is recommended.

    Raises:
        PccError: there is no such probe any more, or it cannot be fitted.
    """
    (probe,) = named_probes(scene, [report.probe])
    settings = report.measurements[found.recommended].settings
    apply(probe, settings)
    partner = partner_of(probe, scene, view_layer) if settings.paired else None
    if partner is not None:
        apply(partner, settings)
    if settings.fitted:
        _fit(scene, view_layer, probe)
    probe.pcc_probe.advice = found.sentences[0] if found.winner is Winner.PATH else ""
    return probe
