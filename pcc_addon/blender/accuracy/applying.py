"""Writing what a cost run recommends into a probe, and where its results go."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...core.accuracy.advice import Advice, Winner
from ...core.accuracy.records import CostReport
from ..read.probes import named_probes
from .bench import apply


def results_folder(blend: Path) -> Path:
    """A folder beside a .blend, named after it."""
    return blend.with_suffix(".cost")


def apply_to(scene: bpy.types.Scene, report: CostReport, found: Advice) -> bpy.types.Object:
    """Write the recommended settings into the probe that was measured; its bake is out of date then.

    Where path tracing wins the probe remembers why, and the plan says so.

    Args:
        scene: that has the probe.
        report: what was measured.
        found: what follows from it; something is recommended.

    Raises:
        PccError: there is no such probe any more.
    """
    (probe,) = named_probes(scene, [report.probe])
    apply(probe, report.measurements[found.recommended].settings)
    probe.pcc_probe.advice = found.sentences[0] if found.winner is Winner.PATH else ""
    return probe
