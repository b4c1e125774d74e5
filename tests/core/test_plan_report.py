"""A plan as text and as records, word for word."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

from pcc_addon.core import plan_report
from pcc_addon.core.costs import Cost, CostTable, cost_table
from pcc_addon.core.decisions import Decision, Effect
from pcc_addon.core.material_plan import MaterialPlan
from pcc_addon.core.plan import make_plan
from pcc_addon.core.plan_report import lines, records, told
from pcc_addon.core.probe_plan import ProbePlan
from pcc_addon.core.readings import MaterialReading, ProbeReading, SceneReading
from pcc_addon.core.surface_plan import SurfacePlan

from .scenes import material, placement, probe, surface

SCENE = SceneReading(
    "Scene",
    (ProbeReading("Broken", None, "probe 'Broken' is faulty"), probe("A"), probe("B", 10.0), probe("C", 90.0)),
    (
        MaterialReading("Linked", (), ("is linked",)),
        material("Wood", surface("Good"), surface("Odd", Anisotropic=None, Roughness=0.9)),
    ),
    (placement("Here", "Wood", "Linked"), placement("There", "Wood", x=10.0)),
)
PLAN = make_plan(SCENE)
GOOD = PLAN.materials[1].served["Good",].effects.label


def test_the_text_says_everything() -> None:
    def decisions(plan: ProbePlan | MaterialPlan | SurfacePlan, indent: int) -> list[str]:
        assert plan.decisions
        return [" " * indent + told(decision) for decision in plan.decisions]

    a, b, c = PLAN.probes
    wood = PLAN.materials[1]
    assert [line for line in lines(PLAN) if not line.startswith("costs and savings")] == [
        "probe 'A': aligned box, inside, centred, off the walls; 3 pictures",
        "    1 materials show it",
        "    shares 'Wood' with other probes, by place",
        *decisions(a, 4),
        "probe 'B': aligned box, inside, centred, off the walls; 3 pictures",
        "    1 materials show it",
        "    shares 'Wood' with other probes, by place",
        *decisions(b, 4),
        "probe 'C': aligned box, inside, centred, off the walls; 8 pictures",
        "    no material shows it",
        "    needs no bake: no object is in its influence",
        *decisions(c, 4),
        "material 'Linked': no probe",
        "    is linked; left as it is",
        "material 'Wood': 'A', 'B'",
        *decisions(wood, 4),
        "    object 'Here' shows 'A'",
        "    object 'There' shows 'B'",
        f"    surface 'Good': roughness 0.25; {GOOD}",
        *decisions(wood.surfaces[0], 8),
        "    surface 'Odd': keeps its own lobe: "
        "has an anisotropy that varies (a constant one would show a probe); "
        "its roughness 0.9 is above the scene's limit 0.6",
        "probe 'Broken' is faulty",
    ]


def test_a_decision_is_told_with_what_it_costs_or_saves(monkeypatch) -> None:
    table = CostTable({"fade": Cost(5, 1.064, 1.0)}, "a machine")
    monkeypatch.setattr(plan_report, "cost_table", lambda: table)
    on = Decision(Effect.FADE, True, "surfaces leave it")
    assert told(on) == "[on] Fade Outside: surfaces leave it (costs Cycles ×1.06)"
    assert told(replace(on, on=False)).endswith("(saves Cycles ×1.06)")
    assert told(Decision(Effect.TURN, False, "no")) == "[off] Turned Box: no"
    assert (
        Cost(1, 1.01, 0.95).words == "less than can be measured" and Cost(None, None, None, 1.5).words == "bake ×1.50"
    )
    assert list(lines(PLAN))[-1] == "costs and savings: with ÷ without the effect, measured on a machine"
    [fade] = [effect for effect in next(records(PLAN))["effects"] if effect["effect"] == "fade"]
    assert fade["cost"]["cycles"] == 1.064 and fade["cost"]["bake"] is None and not fade["on"]


def plain(decision: Decision) -> dict[str, object]:
    return {
        "effect": decision.effect.key,
        "on": decision.on,
        "why": decision.why,
        "forced": decision.forced,
        "cost": asdict(cost_table().of(decision.effect)),
    }


def test_the_records_say_everything() -> None:
    found = list(records(PLAN))
    assert found == json.loads(json.dumps(found)), "plain values"
    a, b, c, linked, wood, note = found
    first, unseen, other = PLAN.probes[0], PLAN.probes[2], PLAN.materials[1]
    assert c["unneeded"] == unseen.unneeded != ""
    assert a == {
        "about": "probe",
        "probe": "A",
        "lookup": "aligned box, inside, centred, off the walls",
        "pictures": ["radiance-0", "radiance-4", "radiance-5"],
        "faces": ["+X", "-X", "+Y", "-Y", "+Z", "-Z"],
        "reasons": list(first.reasons),
        "unneeded": "",
        "effects": [plain(decision) for decision in first.decisions],
    }
    assert b["probe"] == "B"
    assert linked == {
        "about": "material",
        "material": "Linked",
        "probes": [],
        "objects": [],
        "surfaces": [],
        "choices": [],
        "reasons": ["is linked; left as it is"],
        "effects": [],
    }
    assert wood == {
        "about": "material",
        "material": "Wood",
        "probes": ["A", "B"],
        "objects": [{"object": "Here", "probe": "A"}, {"object": "There", "probe": "B"}],
        "surfaces": [
            {
                "path": ["Good"],
                "effects": GOOD,
                "reasons": ["roughness 0.25", GOOD],
                "decisions": [plain(decision) for decision in other.surfaces[0].decisions],
            },
            {
                "path": ["Odd"],
                "effects": None,
                "reasons": [
                    "has an anisotropy that varies (a constant one would show a probe)",
                    "its roughness 0.9 is above the scene's limit 0.6",
                ],
                "decisions": [],
            },
        ],
        "choices": [],
        "reasons": [],
        "effects": [plain(decision) for decision in other.decisions],
    }
    assert note == {"about": "note", "note": "probe 'Broken' is faulty"}


def test_what_was_chosen_is_told() -> None:
    plan = make_plan(
        SceneReading("S", (probe("A"),), (material("Wood", allowed=frozenset()),), (placement("O", "Wood"),))
    )
    told_choice = "its Show Probes is off"
    assert f"    {told_choice}" in lines(plan) and [*records(plan)][1]["choices"] == [told_choice]
