"""What `pcc cost` may be asked; nothing here needs Blender."""

from __future__ import annotations

import argparse
import math
from pathlib import Path


def add_cost_options(cost: argparse.ArgumentParser) -> None:
    """Say which options there are."""
    cost.add_argument("--probe", default="", metavar="NAME", help="which (may be left out where there is one)")
    cost.add_argument("--camera", default="", metavar="NAME", help="whose picture is compared (the scene's)")
    cost.add_argument("--engine", choices=["CYCLES", "EEVEE"], type=str.upper, help="whose frames (the scene's)")
    cost.add_argument(
        "--frames", type=_count, default=1, metavar="N", help="successive frames, from the file's on; 3 show flicker"
    )
    goal = cost.add_mutually_exclusive_group()
    goal.add_argument(
        "--target-error", type=_positive, metavar="X", help="relative error to meet, such as 0.05, as cheaply as can be"
    )
    goal.add_argument("--budget", type=_positive, metavar="SECONDS", help="that all may take (600; 90 with --quick)")
    cost.add_argument("--quick", action="store_true", help="a quarter of the pixels, in a minute and a half")
    cost.add_argument(
        "--width", type=_count, metavar="PX", help="of the pictures (otherwise as many pixels as 480 × 270)"
    )
    cost.add_argument("--resume", action="store_true", help="go on with the run that was kept in the folder")
    cost.add_argument("--out", type=Path, metavar="DIR", help="where results go (NAME.cost beside the file)")
    cost.add_argument("--called", default="", help=argparse.SUPPRESS)  # the file that a copy was made of to be measured
    cost.add_argument("--apply", action="store_true", help="write the recommended settings into the probe")


def _positive(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0.0):
        raise argparse.ArgumentTypeError(f"'{text}' is no number above 0")
    return number


def _count(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number above 0")
    return int(text)
