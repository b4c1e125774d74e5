"""A process that does what `pcc` does as soon as it is told to: `python -m tests.faults.victim`.

It says "ready" once Blender has started, which takes longest, and then reads the arguments, a JSON list in one line.
"""

from __future__ import annotations

import json
import os
import sys

import bpy  # noqa: F401 — registered below

import pcc_addon
from pcc_addon.cli import run_in_blender

pcc_addon.register()
print("ready", flush=True)
code = run_in_blender(json.loads(sys.stdin.readline()))
sys.stdout.flush()
os._exit(code)
