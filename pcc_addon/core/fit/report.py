"""A fit in words, and as a record for machines."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from ..probe import Box
from .records import Fit


def headline(fit: Fit) -> str:
    """The box before and after, in one line."""
    moved = float(np.linalg.norm(fit.after.centre - fit.before.centre))
    return (
        f"box {_size(fit.before)} → {_size(fit.after)}, moved by {moved:.3f} m, turned by {fit.turned:.2f}°; "
        f"{fit.found} of 6 walls found"
    )


def lines(fit: Fit) -> list[str]:
    """What there is to say of a fit after its headline."""
    said = [
        f"misfit before: {fit.misfit_before}",
        f"misfit after: {fit.misfit_after}",
        f"capture point {_place(fit.point_before)}{_to(fit)}",
    ]
    return [*said, *(f"wall {wall}" for wall in fit.walls), *fit.warnings]


def record(fit: Fit) -> dict[str, object]:
    """The same for machines: lengths in metres, world space; matrices row by row, as `probe.Box` has them."""
    return {
        "before": _box(fit.before) | {"capture_point": fit.point_before, "misfit": asdict(fit.misfit_before)},
        "after": _box(fit.after)
        | {"capture_point": fit.point_after, "capture_offset": fit.capture_offset, "misfit": asdict(fit.misfit_after)},
        "turned": fit.turned,
        "leaning": fit.leaning,
        "walls": [asdict(wall) for wall in fit.walls],
        "warnings": list(fit.warnings),
    }


def _size(box: Box) -> str:
    return " × ".join(f"{2.0 * half:.3f}" for half in box.half_extents) + " m"


def _place(point: tuple[float, float, float]) -> str:
    return "({:.2f}, {:.2f}, {:.2f})".format(*point)


def _to(fit: Fit) -> str:
    distance = float(np.linalg.norm(np.subtract(fit.point_after, fit.point_before)))
    return " stays" if distance < 1e-3 else f" → {_place(fit.point_after)}"


def _box(box: Box) -> dict[str, object]:
    return {"centre": box.centre.tolist(), "half_extents": box.half_extents.tolist(), "matrix": list(box.matrix)}
