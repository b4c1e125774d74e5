"""What an artist is told unasked: each thing once, what is alike together."""

from __future__ import annotations

from pcc_addon.core.effects.surface import SurfaceEffects
from pcc_addon.core.material_plan import MaterialPlan
from pcc_addon.core.parts import Division
from pcc_addon.core.plan import Plan
from pcc_addon.core.remarks import remarks
from pcc_addon.core.surface_plan import SurfacePlan


def left(name: str, roughness: float, *reasons: str) -> MaterialPlan:
    surface = SurfacePlan(("BSDF",), None, (roughness, roughness), reasons)
    return MaterialPlan(name, Division(()), (), (surface,), ())


ROUGH = [left(name, 0.9, "its roughness 0.9 is above the scene's limit 0.6") for name in ("Chalk", "Carpet")]
CLEAR = left("Velvet", 0.3, "its anisotropy varies")
BOTH = left("Felt", 0.9, "its roughness 0.9 is above the scene's limit 0.6", "its anisotropy varies")


def test_what_is_merely_rough_is_told_together_and_last() -> None:
    told = remarks(Plan((), (ROUGH[0], CLEAR, BOTH, ROUGH[1]), ("probe 'Hall' is nowhere",)), 0.6)
    assert told[0] == "probe 'Hall' is nowhere"
    assert [sentence.split("'")[1] for sentence in told[1:3]] == ["Velvet", "Felt"]
    assert told[3:] == ("2 materials are rougher than the scene's Roughness Limit of 0.6 and keep their own lobes",)


def test_one_rough_material_has_its_own_sentence() -> None:
    [told] = remarks(Plan((), (ROUGH[0],)), 0.6)
    assert "'Chalk'" in told and "0.9 is above" in told


def test_a_material_that_has_other_reasons_is_not_merely_rough() -> None:
    whole = MaterialPlan("Wall", Division(()), (), ROUGH[0].surfaces, ("shows no probe: it is linked",))
    told = remarks(Plan((), (*ROUGH, whole)), 0.6)
    assert told[0] == "material 'Wall' shows no probe: it is linked" and told[-1].startswith("2 materials")


def test_where_nothing_is_left_alone_nothing_is_said() -> None:
    assert remarks(Plan((), ()), 0.6) == ()


def test_a_surface_at_the_limit_is_not_too_rough() -> None:
    at_the_limit = [left(name, 0.6, "its anisotropy varies") for name in ("Silk", "Satin")]
    assert [told.split("'")[1] for told in remarks(Plan((), tuple(at_the_limit)), 0.6)] == ["Silk", "Satin"]


def test_a_material_of_which_a_rough_surface_shows_a_probe_is_not_merely_rough() -> None:
    served = SurfacePlan(("Gloss",), SurfaceEffects(()), (0.9, 0.9), ("forced",))
    both = [MaterialPlan(m.material, Division(("Hall",)), (), (served, *m.surfaces), ()) for m in ROUGH]
    assert [told.split("'")[1] for told in remarks(Plan((), tuple(both)), 0.6)] == ["Chalk", "Carpet"]
