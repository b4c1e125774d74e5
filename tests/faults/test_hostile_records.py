"""Records and measurements that somebody wrote to do harm: they are read or refused in words, and nothing else."""

from __future__ import annotations

import json

import bpy

from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.status import statuses
from pcc_addon.core.accuracy import files as cost_files
from pcc_addon.core.errors import BakeError, PccError
from pcc_addon.core.sidecar import Sidecar
from tests.core.cost_reports import example, ladder
from tests.core.test_sidecar import RECORD

from . import hostile
from .hall import Hall, check_next_bake
from .tally import fault


def outcome(read: object, text: str, refused: type[Exception]) -> object:
    """What is read, or the sentence that refuses it."""
    try:
        return read(text)
    except refused as error:
        return str(error)


def test_every_spoilt_sidecar_is_read_or_refused_in_words() -> None:
    spoilt = hostile.spoilt(json.loads(RECORD.to_json()))
    texts = {**hostile.TEXTS, **{name: json.dumps(document) for name, document in spoilt}}
    assert len(texts) > 500
    for name, text in texts.items():
        with fault("hostile sidecars"):
            found = outcome(lambda text: Sidecar.from_json(text, "hall.json"), text, BakeError)
            if isinstance(found, Sidecar):
                assert Sidecar.from_json(found.to_json(), "again") == found, name
                for level in found.levels:
                    assert not set(level.file) & set("/\\:\0") and level.file not in ("", ".", ".."), name
                    assert max(level.width, level.height, level.size) < 2**53
            else:
                assert "hall.json" in found and ("bake" in found or "update" in found), name


def test_every_spoilt_measurement_is_read_or_refused_in_words() -> None:
    document = json.loads(cost_files.to_json(example(ladder()[:2])))
    del document["derived"]  # nobody reads it back
    texts = {**hostile.TEXTS, **{name: json.dumps(each) for name, each in list(hostile.spoilt(document))[::5]}}
    for name, text in texts.items():
        with fault("hostile measurements"):
            found = outcome(cost_files.from_json, text, PccError)
            assert not isinstance(found, str) or "cost.json" in found, name


def test_a_record_in_the_file_that_is_spoilt_stops_nothing(place: Hall) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    probe = next(probe for probe in all_probes(bpy.context.scene) if probe.name == "Probe")
    record = probe.pcc_probe.bake_record
    drawn = list(hostile.spoilt(json.loads(record)))
    drawn = [each for each in drawn if each[0].split(".")[0] not in ("convention",)][::37]
    texts = {**hostile.TEXTS, **{name: json.dumps(document) for name, document in drawn}}
    for name, text in texts.items():
        with fault("hostile records in a .blend"):
            probe.pcc_probe.bake_record = text.replace("\0", "")
            found = {status.probe: status for status in statuses(bpy.context.scene, bpy.context.view_layer)}
            assert found["Second"].state == "stale", name
            assert found["Probe"].state in ("stale", "error", "unbaked"), (name, found["Probe"])
            bpy.ops.pcc.inject()
    bpy.ops.wm.save_mainfile()
    check_next_bake(place)
