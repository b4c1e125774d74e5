"""Draw the plots of a cost.json: python3 plots.py COST.JSON FOLDER

Needs matplotlib and nothing of the add-on, so that any Python can run it by its path, outside Blender too. Writes
error_bake, error_frame and error_rungs into the folder, each as PNG and as SVG.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

INK = "#7a7b7c"
"""The colour of axes and words: to be seen on white and on black, and replaced where a page knows better."""

NAMES = ("error_frame", "error_bake", "error_rungs")
# Okabe and Ito's colours, which most people can tell apart; of black in its stead grey.
_COLOURS = {"NONE": "#999999", "BOX": "#0072b2", "RELIEF": "#d55e00", "SPHERE": "#cc79a7"}
_LABELS = {"NONE": "classic", "BOX": "box", "RELIEF": "relief", "SPHERE": "Blender's sphere probe"}
_PATH, _DENOISED, _CHOSEN, _TARGET = "#009e73", "#56b4e9", "#e69f00", "#c0392b"
_NOTHING = dict.fromkeys(("Date", "Creator", "Format", "Type"))  # of an SVG's own notes
_BARS = 24  # of the smallest errors; more could not be read


def main(arguments: list[str]) -> int:
    """Draw; 0 where all is drawn, 2 where the arguments are wrong, 1 where matplotlib is not there."""
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        import matplotlib
    except ImportError:
        print("matplotlib is missing: python3 -m pip install matplotlib", file=sys.stderr)
        return 1
    matplotlib.use("Agg")
    document = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
    folder = Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    for path in draw(document, folder):
        print(path)
    return 0


def draw(document: dict[str, Any], folder: Path) -> list[Path]:
    """Draw all plots of what `files.to_json` wrote, and say where they are."""
    import matplotlib
    from matplotlib.figure import Figure

    style: dict[str, Any] = {
        "font.size": 10,
        "svg.fonttype": "none",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "legend.frameon": False,
    }
    words = ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color", "grid.color")
    drawers = {
        "error_frame": lambda axes: _scatter(axes, document, "FRAME"),
        "error_bake": lambda axes: _scatter(axes, document, "BAKE"),
        "error_rungs": lambda axes: _bars(axes, document),
    }
    written = []
    for name in NAMES:
        height = 5.2 if name != "error_rungs" else 1.3 + 0.24 * min(len(_bar_order(document)), _BARS)
        for kind, ink in (("svg", INK), ("png", "#333333")):
            with matplotlib.rc_context({**style, **dict.fromkeys(words, ink), "svg.hashsalt": name}):
                figure = Figure(figsize=(6.6, height), layout="constrained")
                drawers[name](figure.add_subplot())
                how = (
                    {"transparent": True, "metadata": _NOTHING} if kind == "svg" else {"facecolor": "white", "dpi": 150}
                )
                written.append(folder / f"{name}.{kind}")
                figure.savefig(written[-1], **how)
    return written


def _scatter(axes: Any, document: dict[str, Any], axis: str) -> None:
    """Error against seconds, both logarithmic; what has no seconds on this axis is a level line or left out."""
    report, derived = document["report"], document["derived"]
    field = "bake_seconds" if axis == "BAKE" else "frame_seconds"
    measured = report["measurements"]
    shown = [i for i, one in enumerate(measured) if one["settings"]["kind"] != "PATH" and one[field] > 0.0]
    floor = _floor(derived["errors"])
    error = [max(value, floor) for value in derived["errors"]]
    for group in _COLOURS:
        places = [i for i in shown if _group(measured[i]["settings"]) == group]
        if places:
            mark = "^" if group == "SPHERE" else "o"
            times = [measured[i][field] for i in places]
            axes.plot(times, [error[i] for i in places], mark, color=_COLOURS[group], label=_LABELS[group], ms=5.5)
    front = [i for i in derived["fronts"][axis] if measured[i][field] > 0.0]
    if len(front) > 1:
        times, errors = [measured[i][field] for i in front], [error[i] for i in front]
        axes.plot(times, errors, "-", color=_ink(), lw=1.6, zorder=1.5, drawstyle="steps-post", label="front")
    chosen = derived["recommended"]
    for curve in derived["curves"]:
        colour = _DENOISED if curve["denoised"] else _PATH
        if axis == "FRAME":
            times = [point[0] for point in curve["points"]]
            errors = [max(point[1], floor) for point in curve["points"]]
            axes.plot(times, errors, "s-", color=colour, lw=1.2, ms=4, label=curve["name"])
    if report.get("target"):
        axes.axhline(report["target"], color=_TARGET, lw=1.0, ls="--", label="target")
    if report["truth"]["noise"] > floor:
        axes.axhline(report["truth"]["noise"], color=_ink(), lw=0.9, ls=":", label="noise of the truth")
    if chosen is not None and measured[chosen][field] > 0.0:
        place = (measured[chosen][field], error[chosen])
        axes.plot(*place, "o", ms=13, mfc="none", mec=_CHOSEN, mew=2.2, label="recommended")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("seconds to bake" if axis == "BAKE" else "seconds a frame")
    axes.set_ylabel("error (relative RMSE)")
    _percent(axes.yaxis)
    _plain(axes.xaxis)
    axes.grid(True, which="major", alpha=0.25, lw=0.6)
    axes.set_title(_title(report), loc="left", fontsize=10)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(-0.02, -0.13), ncols=4, columnspacing=1.4)


def _bars(axes: Any, document: dict[str, Any]) -> None:
    """A bar for each measurement, the smallest error on top."""
    report, derived = document["report"], document["derived"]
    measured, errors = report["measurements"], derived["errors"]
    order = _bar_order(document)[:_BARS]
    left_out = len(measured) - len(order)
    colours = [_colour(measured[i]["settings"]) for i in order]
    bars = axes.barh(range(len(order)), [100.0 * errors[i] for i in order], color=colours, height=0.72)
    if derived["recommended"] in order:
        bars[order.index(derived["recommended"])].set(edgecolor=_CHOSEN, linewidth=2.2)
    for place, i in enumerate(order):
        axes.annotate(
            f"{100.0 * errors[i]:.2g}",
            (100.0 * errors[i], place),
            (3, 0),
            textcoords="offset points",
            va="center",
            size=7,
        )
    axes.set_yticks(range(len(order)), [_short(measured[i]["settings"]) for i in order], fontsize=7.5)
    axes.set_ylim(len(order) - 0.4, -0.6)
    axes.set_xlabel("error (relative RMSE), %" + (f"; {left_out} larger ones left out" if left_out else ""))
    if report.get("target"):
        axes.axvline(100.0 * report["target"], color=_TARGET, lw=1.0, ls="--")
    axes.set_title(_title(report), loc="center", fontsize=10)


def _bar_order(document: dict[str, Any]) -> list[int]:
    errors = document["derived"]["errors"]
    return sorted(range(len(errors)), key=lambda i: (errors[i], i))


def _group(settings: dict[str, Any]) -> str:
    return "SPHERE" if settings["kind"] == "SPHERE" else settings["correction"]


def _colour(settings: dict[str, Any]) -> str:
    if settings["kind"] == "PATH":
        return _DENOISED if settings["frame_denoise"] else _PATH
    return _COLOURS.get(_group(settings), "#999999")


def _short(settings: dict[str, Any]) -> str:
    frame = f"{settings['frame_samples']}{' denoised' if settings['frame_denoise'] else ''}"
    if settings["ray_tracing"]:
        frame += ", ray tracing"
    if settings["kind"] == "PATH":
        return f"{'path tracing' if settings['engine'] == 'CYCLES' else 'EEVEE without probes'} {frame}"
    if settings["kind"] == "SPHERE":
        parallax = ", box" * (settings["correction"] == "BOX")
        return f"sphere probe{parallax} {settings['resolution']} px, frame {frame}"
    bake = f"{settings['bake_samples']}{' denoised' if settings['bake_denoise'] else ''}"
    relief = f" {settings['steps']}+{settings['refinements']}" if settings["correction"] == "RELIEF" else ""
    more = ", half" * settings["half_float"] + ", adaptive" * bool(settings.get("bake_adaptive"))
    name = _LABELS.get(settings["correction"], "?") + " fitted" * bool(settings.get("fitted"))
    name += " twice" * bool(settings.get("paired"))
    return f"{name}{relief} {settings['resolution']} px × {bake}{more}, frame {frame}"


def _ink() -> str:
    import matplotlib

    return str(matplotlib.rcParams["text.color"])


def _floor(errors: list[float]) -> float:
    """What stands for errors of 0, which have no logarithm: a tenth of the smallest other."""
    return min([error for error in errors if error > 0.0], default=1e-3) / 10.0


def _percent(axis: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = sorted(axis.get_view_interval())
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 1000.0 * low else (1.0,)))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{100.0 * value:.3g} %"))


def _plain(axis: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = sorted(axis.get_view_interval())
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 1000.0 * low else (1.0,)))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))


def _title(report: dict[str, Any]) -> str:
    """Where all is from; a dollar would begin a formula."""
    text = f"{report['file']}, probe {report['probe']}, camera {report['camera']}, {report['engine'].title()}"
    return (text if len(text) <= 90 else text[:89] + "…").replace("$", r"\$").replace("Eevee", "EEVEE")


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
