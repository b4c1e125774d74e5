"""The fade beyond the box, and what a surface outside shows, on the families of hard cases."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from tests.core.boxes import unit

from .bound import REFLECT, direction_bound
from .fades import exact_weight, fades
from .families import CORRECTIONS
from .reference import angle, exact
from .rounding import ROUNDOFF
from .run import together, values

COUNT = 1024


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
