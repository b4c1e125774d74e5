"""Probes in glTF: an extension of the probe's node, in glTF's own axes, with what Blender needs to have it back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import PccError
from ..probe import ProbeSpec
from .axes import AS_IT_IS, Axes

NAME = "PCC_parallax_probe"
VERSION = 1
_Y_UP = Axes("+X", "+Z", "-Y")


def extension(spec: ProbeSpec, display_size: float, settings: Mapping[str, Any], *, y_up: bool) -> dict[str, Any]:
    """What a probe's node is given: plain values.

    Args:
        spec: the probe.
        display_size: half an edge of the box along the node's axes, before the node's transform.
        settings: of Blender, by the names of `Object.pcc_probe`, in the axes of Blender's object.
        y_up: whether the file's axes are glTF's own, as the format wants.
    """
    axes = _Y_UP if y_up else AS_IT_IS
    influence = spec.influence
    low, high = ([float(v) for v in end] for end in _turned_ends(axes, influence.low, influence.high))
    return {
        "version": VERSION,
        "halfExtents": [float(display_size)] * 3,
        "captureOffset": [float(v) + 0.0 for v in axes.matrix @ spec.capture_offset],
        "padding": spec.padding,
        "falloff": spec.falloff,
        "influence": {"low": low, "high": high, "weight": influence.weight, "priority": influence.priority},
        "parallax": spec.corrected,
        "outside": spec.outside.value.lower(),
        "blender": dict(settings),
    }


def levels(buffer_view: Any, roughnesses: Sequence[float], width: int, captured_at: Sequence[float]) -> dict[str, Any]:
    """What is said of a cubemap that lies in the file.

    Args:
        buffer_view: what becomes the index of a buffer view.
        roughnesses: of its levels.
        width: texels across a face.
        captured_at: where it was taken, in Blender's world, metres.
    """
    return {
        "bufferView": buffer_view,
        "mimeType": "image/ktx2",
        "faceWidth": width,
        "roughnesses": list(roughnesses),
        "capturePoint": [float(v) + 0.0 for v in _Y_UP.matrix @ captured_at],
    }


def settings_of(found: object, node: str) -> tuple[float, dict[str, Any]]:
    """The display size and Blender's settings in a node's extension that `extension` wrote.

    Raises:
        PccError: it is none, or of a later version.
    """
    try:
        if found["version"] > VERSION:  # type: ignore[index]
            raise PccError(f"node '{node}': its probe was written by a later version of the add-on; update it")
        size = float(found["halfExtents"][0])  # type: ignore[index]
        if not 0.0 < size < 1e30:
            raise ValueError("its box has no size")
        return size, dict(found["blender"])  # type: ignore[index]
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise PccError(f"node '{node}': its probe cannot be read ({error}); add one by hand") from error


def _turned_ends(axes: Axes, low: Sequence[float], high: Sequence[float]) -> tuple[list[float], list[float]]:
    """Lengths beyond the low and the high faces, in other axes; where one is turned round its ends change places."""
    found: tuple[list[float], list[float]] = ([], [])
    for side in axes.names:
        ends = (low, high) if side[0] == "+" else (high, low)
        for into, end in zip(found, ends, strict=True):
            into.append(end["XYZ".index(side[1])])
    return found
