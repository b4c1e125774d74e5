"""A plan as text and as records, word for word."""

from __future__ import annotations

import json

from pcc_addon.core.pictures import LADDER
from pcc_addon.core.plan import make_plan
from pcc_addon.core.plan_report import lines, records
from pcc_addon.core.readings import MaterialReading, ProbeReading, SceneReading

from .scenes import material, placement, probe, surface

SCENE = SceneReading(
    "Scene",
    (ProbeReading("Broken", None, "probe 'Broken' is faulty"), probe("A"), probe("B", 10.0)),
    (
        MaterialReading("Linked", (), ("is linked",)),
        material("Wood", surface("Good"), surface("Odd", Anisotropic=None, Roughness=0.9)),
    ),
    (placement("Here", "Wood", "Linked"), placement("There", "Wood", x=10.0)),
)
PLAN = make_plan(SCENE)
GOOD = PLAN.materials[1].served["Good",].effects.label


def test_the_text_says_everything() -> None:
    assert list(lines(PLAN)) == [
        f"probe 'A': aligned box, inside, centred; {len(LADDER)} pictures",
        "    1 materials show it",
        "    shares 'Wood' with other probes, by place",
        "    all levels, so that a changed roughness needs no new bake",
        f"probe 'B': aligned box, inside, centred; {len(LADDER)} pictures",
        "    1 materials show it",
        "    shares 'Wood' with other probes, by place",
        "    all levels, so that a changed roughness needs no new bake",
        "material 'Linked': no probe",
        "    is linked; left as it is",
        "material 'Wood': 'A', 'B'",
        "    object 'Here' shows 'A'",
        "    object 'There' shows 'B'",
        f"    surface 'Good': roughness 0.25; {GOOD}",
        "    surface 'Odd': keeps its own lobe: "
        "has an anisotropy that varies (a constant one would show a probe); "
        "its roughness 0.9 is above the scene's limit 0.6",
        "probe 'Broken' is faulty",
    ]


def test_the_records_say_everything() -> None:
    found = list(records(PLAN))
    assert found == json.loads(json.dumps(found)), "plain values"
    a, b, linked, wood, note = found
    assert a == {
        "about": "probe",
        "probe": "A",
        "lookup": "aligned box, inside, centred",
        "pictures": [f"radiance-{k}" for k in range(len(LADDER))],
        "faces": ["+X", "-X", "+Y", "-Y", "+Z", "-Z"],
        "reasons": list(PLAN.probes[0].reasons),
    }
    assert b["probe"] == "B"
    assert linked == {
        "about": "material",
        "material": "Linked",
        "probes": [],
        "objects": [],
        "surfaces": [],
        "reasons": ["is linked; left as it is"],
    }
    assert wood == {
        "about": "material",
        "material": "Wood",
        "probes": ["A", "B"],
        "objects": [{"object": "Here", "probe": "A"}, {"object": "There", "probe": "B"}],
        "surfaces": [
            {"path": ["Good"], "effects": GOOD, "reasons": ["roughness 0.25", GOOD]},
            {
                "path": ["Odd"],
                "effects": None,
                "reasons": [
                    "has an anisotropy that varies (a constant one would show a probe)",
                    "its roughness 0.9 is above the scene's limit 0.6",
                ],
            },
        ],
        "reasons": [],
    }
    assert note == {"about": "note", "note": "probe 'Broken' is faulty"}
