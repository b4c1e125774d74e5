"""Run by another Python, with its own Blender: builds a file of `filing.py`, or opens and saves one, and tells of it.

`python other_blender.py build|save|look FILE`; the last line is JSON. `look` has no add-on.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))


def main(act: str, blend: Path) -> None:
    import pcc_addon
    from tests.blender import filing

    if act != "look":
        pcc_addon.register()
    if act == "build":
        filing.build(blend)
        bpy.data.materials["Wood"].pcc.probe = bpy.data.objects["Probe"]
        bpy.data.materials["Floor"].pcc.effects.metal = "ON"
        bpy.data.objects["Probe"].pcc_probe.weight = 0.75
    elif act == "save":
        filing.opened(blend)
    else:
        bpy.ops.wm.open_mainfile(filepath=str(blend))
    if act != "look":
        bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    told = {"mean": float(filing.seen(16).mean())}
    if act != "look":
        told |= filing.kept()
        pcc_addon.unregister()
    print(json.dumps(told))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
