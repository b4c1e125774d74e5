"""The fade beyond the box, and what a surface outside shows, on the families of hard cases."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.probe import STEEPEST_FALLOFF
from tests.core.boxes import unit

from .bound import ALONG, REFLECT, ROUNDOFF, direction_bound
from .cases import Cases
from .families import CORRECTIONS
from .reference import Exact, angle, exact
from .run import together, values

COUNT = 1024
STEEPEST = 1.5  # of the fade, 3 t² − 2 t³, in the middle


def fades(cases: Cases, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Paddings and falloffs in metres; a tenth of the falloffs are edges."""
    least = cases.half_widths.min(-1)
    falloff = np.where(rng.random(len(cases)) < 0.1, 0.0, least * 10.0 ** rng.uniform(-3.0, 0.5, len(cases)))
    padding = least * 10.0 ** rng.uniform(-5.0, -2.0, len(cases))
    return {"Padding": padding.astype(np.float32), "Falloff": np.maximum(falloff, STEEPEST_FALLOFF).astype(np.float32)}


def exact_weight(cases: Cases, truth: Exact, fade: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The weight (n,) in float64, and how far rounding may lead it astray."""
    padding, falloff = (fade[name].astype(np.float64) for name in ("Padding", "Falloff"))
    half = cases.half_widths.astype(np.float64)
    outside = (np.abs(truth.origin) - half).max(-1) - padding
    steps = np.clip(1.0 - outside / falloff, 0.0, 1.0)
    reach = np.linalg.norm(cases.position.astype(np.float64) - cases.centre, axis=-1)
    # P − C, the dot products; then |q| − h, its difference from the padding, the division and 1 − x
    lost = ROUNDOFF * ((1 + ALONG[cases.correction]) * reach + (reach + half.max(-1)) + np.abs(outside))
    lost = lost / falloff + 2 * ROUNDOFF
    return steps * steps * (3.0 - 2.0 * steps), np.minimum(STEEPEST * lost + 6 * ROUNDOFF, 1.0)


@pytest.mark.parametrize("outside", list(Outside), ids=lambda o: o.value)
@pytest.mark.parametrize("correction", CORRECTIONS, ids=lambda c: c.value)
def test_what_fades_stays_within_its_bound(scene, correction: Correction, outside: Outside) -> None:
    cases, where = together(COUNT, correction)
    fade = fades(cases, np.random.default_rng(41))
    found = values(cases, formula.lookup(LookupEffects(correction, outside)), fade)
    assert outside is not Outside.UNCORRECTED or found["Direction"].any(-1)[exact(cases).ray.any(-1)].mean() > 0.999
    truth = exact(cases)
    weight, weight_bound = exact_weight(cases, truth, fade)
    if outside is not Outside.UNCORRECTED:
        off = np.abs(found["Weight"] - weight) > weight_bound
        assert not off.any(), {name: int(off[part].sum()) for name, part in where.items() if off[part].any()}
        assert min((weight == 1.0).mean(), (weight == 0.0).mean(), (weight % 1.0 > 0.0).mean()) > 0.01
        return
    length = np.linalg.norm(truth.ray, axis=-1)
    corrected = unit(truth.direction)
    mixed = truth.ray * (1.0 - weight[:, None]) + corrected * weight[:, None]
    spread = np.linalg.norm(corrected - truth.ray, axis=-1)
    # the ray, the corrected direction and its normalising, the weight, the mix itself
    lost = ROUNDOFF * REFLECT * length + direction_bound(cases, truth) + 5 * ROUNDOFF + weight_bound * spread
    share = (lost + 4 * ROUNDOFF) / np.maximum(np.linalg.norm(mixed, axis=-1), 1e-300)
    sure = (share < 0.5) & (length > 0.0)
    off = sure & (angle(found["Direction"], mixed) > np.arcsin(np.minimum(share, 1.0)))
    assert not off.any(), {name: int(off[part].sum()) for name, part in where.items() if off[part].any()}
    assert sure.mean() > 0.7
