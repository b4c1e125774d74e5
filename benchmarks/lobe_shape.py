"""Where a rough surface looks its probe up, and at which level: against the integral over its lobe, and path tracing.

python3 dev.py run benchmarks/lobe_shape.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from statistics import median
from unittest.mock import patch

import bpy
import numpy as np

from benchmarks.measure import covered, pixels_of, relative_rmse, render, start, table, write_page
from benchmarks.noise import TWO
from pcc_addon.core import equirect
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dominant import dominant
from pcc_addon.core.effects.fresnel import MIRRORS, Facets, dielectric_facets
from pcc_addon.core.effects.lobe import mean_tilt
from pcc_addon.core.effects.lookup import spread
from pcc_addon.core.effects.surface import REFLECTED, SurfaceEffects
from pcc_addon.core.expression import vector
from pcc_addon.core.ggx import reflected_samples
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.prefilter import prefilter
from pcc_addon.core.probe import Engine
from sample_blends.scenes import (
    EMISSIVE_COLORS,
    EMISSIVE_ROOM,
    add_camera,
    add_room_probe,
    emissive_room,
    principled_node,
)
from sample_blends.two_rooms import two_rooms
from tests.core.lobes import both_sides

ROUGHNESSES = (0.05, 0.1, 0.2, 0.3, 0.45, 0.6)
COSINES = (0.04, 0.08, 0.15, 0.25, 0.4, 0.6, 0.85)
POINTS, HEIGHT, GRID = 60, 256, 72
LOBES = {"metal": MIRRORS, "dielectric": dielectric_facets(1.5)}
Colors = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Surroundings:
    """A room of glowing walls with one-metre squares, and square lamps in its ceiling.

    Attributes:
        half: its half extents, metres.
        colors: of the squares, by wall.
        lamps: x, y and half width, metres; each gives off what one of 40 a square metre of 0.25 m² does.
        capture: where its picture is taken, metres from its centre.
    """

    half: tuple[float, float, float]
    colors: Mapping[str, Colors]
    lamps: tuple[tuple[float, float, float], ...] = ()
    capture: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def met(self, points: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What rays (…, 3) from within meet: (…, 3), exactly; and how far away, (…,) metres."""
        with np.errstate(divide="ignore", invalid="ignore"):
            distances = np.where(ways != 0.0, (np.array(self.half) * np.sign(ways) - points) / ways, np.inf)
        axis = np.maximum(distances, 0.0).argmin(-1)
        far = np.maximum(np.take_along_axis(distances, axis[..., None], -1), 0.0)
        hit = points + far * ways
        seen = np.zeros(hit.shape)
        for side, colors in self.colors.items():
            k = "XYZ".index(side[1])
            here = (axis == k) & ((ways[..., k] > 0.0) == (side[0] == "+"))
            odd = np.floor(np.delete(hit[here], k, -1)).sum(-1) % 2
            seen[here] = np.where(odd[:, None], colors[1], colors[0])
        up = (axis == 2) & (ways[..., 2] > 0.0)
        for x, y, half in self.lamps:
            seen[up & (np.abs(hit[..., :2] - (x, y)) < half).all(-1)] = 40.0 * (0.25 / half) ** 2
        return seen, far[..., 0]

    def levels(self) -> list[np.ndarray]:
        """A ladder of its picture, which is made with three rays squared a texel."""
        ways = equirect.directions(6 * HEIGHT, 3 * HEIGHT)
        seen, _ = self.met(np.broadcast_to(self.capture, ways.shape), ways)
        picture = seen.reshape(HEIGHT, 3, 2 * HEIGHT, 3, 3).mean((1, 3))
        return [prefilter(picture, rung) for rung in LADDER]


def _plain(*color: float) -> Colors:
    return color, color


CHECKERED = Surroundings(
    EMISSIVE_ROOM.half_extents,
    {**EMISSIVE_COLORS, "-Z": ((0.5, 0.45, 0.4), (0.15, 0.13, 0.12))},
    capture=(0.0, 0.0, -0.35),
)
LIT = Surroundings(
    (2.5, 2.5, 1.3),
    {
        **dict.fromkeys(("+X", "-X", "-Y"), _plain(0.5, 0.45, 0.4)),
        "+Y": _plain(0.4, 0.1, 0.05),
        "+Z": _plain(0.3, 0.3, 0.3),
    },
    lamps=((-0.9, -0.4, 0.25), (1.1, 0.7, 0.35)),
)
ROOMS = {"checkered": CHECKERED, "lit by lamps": LIT}


@dataclass(frozen=True)
class Views:
    """Points in a room, on surfaces that lie level and are seen under one angle.

    Attributes:
        room: where.
        points: (n, 3) metres.
        turns: (n, 3, 3) from the frame of the lobe's samples to the room.
        cosine, roughness: of all of them.
        facets: of the lobe.
    """

    room: Surroundings
    points: np.ndarray
    turns: np.ndarray
    cosine: float
    roughness: float
    facets: Facets

    @classmethod
    def some(
        cls,
        room: Surroundings,
        height: float,
        cosine: float,
        roughness: float,
        facets: Facets,
        rng: np.random.Generator,
    ) -> Views:
        """Anywhere in the room at a height above the floor, from anywhere around."""
        azimuth = rng.uniform(0.0, 2.0 * np.pi, POINTS)
        turns = np.zeros((POINTS, 3, 3))
        turns[:, 0, 0] = turns[:, 1, 1] = np.cos(azimuth)
        turns[:, 1, 0] = np.sin(azimuth)
        turns[:, 0, 1] = -turns[:, 1, 0]
        turns[:, 2, 2] = 1.0
        x, y, z = room.half
        points = rng.uniform((0.1 - x, 0.1 - y, height - z), (x - 0.1, y - 0.1, height - z), (POINTS, 3))
        return cls(room, points, turns, cosine, roughness, facets)

    def truth(self) -> np.ndarray:
        """(n, 3): the mean over the lobe, as a white one would reflect it."""
        facet, beside, leaving = reflected_samples(self.cosine, self.roughness, GRID)
        ways, weight = both_sides(beside, leaving * self.facets.curve(facet))
        ways, weight = ways[weight > 0.0], weight[weight > 0.0]
        seen, _ = self.room.met(self.points[:, None], ways @ self.turns.transpose(0, 2, 1))
        return (seen * weight[:, None]).sum(1) / weight.sum()

    def shown(self, levels: list[np.ndarray], way: np.ndarray, hardening: bool) -> np.ndarray:
        """(n, 3): what the probe shows along a way in the lobe's frame."""
        ways = self.turns @ way
        far = self.room.met(self.points, ways)[1][:, None]
        to_hit = self.points + far * ways - self.room.capture
        roughness = np.full(POINTS, self.roughness)
        if hardening:
            roughness = roughness * evaluate({"s": spread(vector("way"))}, {"way": to_hit / far}, np.float64)["s"]
        place = np.interp(roughness, LADDER, np.arange(len(LADDER)))
        share = np.maximum(1.0 - np.abs(place[None] - np.arange(len(LADDER))[:, None]), 0.0)
        return (share[..., None] * np.array([equirect.lookup(level, to_hit) for level in levels])).sum(0)


def tilted(cosine: float, tilt: float) -> np.ndarray:
    """The mirrored view, brought nearer to the normal by an angle in radians."""
    angle = np.arccos(cosine) - tilt
    return np.array([-np.sin(angle), 0.0, np.cos(angle)])


def leant(cosine: float, roughness: float) -> np.ndarray:
    """The normal and the mirrored view, mixed as by Lagarde and de Rousiers 2014."""
    share = (1.0 - roughness) * (np.sqrt(1.0 - roughness) + roughness)
    way = share * tilted(cosine, 0.0) + (0.0, 0.0, 1.0 - share)
    return way / np.linalg.norm(way)


def shipped(view: Views) -> np.ndarray:
    """The direction of this add-on, for a lobe that is alone."""
    incoming = np.array([[np.sqrt(1.0 - view.cosine**2), 0.0, view.cosine]])
    inputs = {"Normal": np.array([[0.0, 0.0, 1.0]]), "Incoming": incoming, "Roughness": view.roughness}
    return evaluate(dominant((view.facets,)).outputs, inputs, np.float64)["Direction"][0]


WAYS: dict[str, tuple[Callable[[Views], np.ndarray], bool]] = {
    "mirrored view": (lambda v: tilted(v.cosine, 0.0), False),
    "lerp(N, R), roughness": (lambda v: leant(v.cosine, v.roughness), False),
    "lerp(N, R), alpha": (lambda v: leant(v.cosine, v.roughness**2), False),
    "mean direction": (lambda v: tilted(v.cosine, mean_tilt(v.cosine, v.roughness, v.facets)), False),
    "halfway to it (chosen)": (shipped, False),
    "mirrored view, hardening": (lambda v: tilted(v.cosine, 0.0), True),
    "chosen, hardening": (shipped, True),
}


def offline() -> tuple[str, str]:
    """The tables by roughness and by angle."""
    rng = np.random.default_rng(3)
    found: dict[tuple[str, str, float, float], list[np.ndarray]] = {}
    for place, room in ROOMS.items():
        levels = room.levels()
        for name, facets in LOBES.items():
            for roughness in ROUGHNESSES:
                for cosine in COSINES:
                    for height in (0.0, 0.7):
                        view = Views.some(room, height, cosine, roughness, facets, rng)
                        found.setdefault((place, name, roughness, cosine), []).append(_squares(view, levels))
    rows, angles = [], []
    for place in ROOMS:
        for name in LOBES:
            for roughness in ROUGHNESSES:
                errors = [e for key, e in found.items() if key[:3] == (place, name, roughness)]
                rows.append([place, name, f"{roughness:g}", *_mean(errors)])
            for cosine in COSINES:
                angle = f"{90.0 - np.degrees(np.arccos(cosine)):.0f}°"
                angles.append([place, name, angle, *_mean([found[place, name, 0.45, cosine]])])
    return table(["room", "lobe", "roughness", *WAYS], rows), table(
        ["room", "lobe", "above the surface", *WAYS], angles
    )


def _squares(view: Views, levels: list[np.ndarray]) -> np.ndarray:
    truth = view.truth()
    shown = [view.shown(levels, way(view), hardening) for way, hardening in WAYS.values()]
    return np.array([np.square(each - truth).mean() / np.square(truth).mean() for each in shown])


def _mean(errors: list[list[np.ndarray]]) -> list[str]:
    return [f"{value:.3f}" for value in np.sqrt(np.concatenate(errors).mean(0))]


@contextmanager
def along_the_mirrored_view() -> Iterator[None]:
    """While this lasts, twins are built as if every surface were looked up along the mirrored view."""
    with patch.object(SurfaceEffects, "_reflected", (REFLECTED,)):
        yield


CAMERAS = {"eye height": (0.0, 240, 135), "0.4 m high": (-1.6, 120, 68)}  # metres from the centre; pixels


def in_the_emissive_room() -> Iterator[list[str]]:
    """Rows of the table of the emissive room with a rough floor."""
    for name, roughness in _floors():
        scene = emissive_room()
        floor = bpy.data.objects["Wall -Z"]
        _make_floor(floor.data.materials[0], name, roughness)
        probe = add_room_probe(EMISSIVE_ROOM, CHECKERED.capture).pcc_probe
        probe.samples, probe.denoise, probe.resolution = 16, False, 256
        bpy.ops.pcc.bake(scope="ALL")
        for place, (height, *size) in CAMERAS.items():
            bpy.data.objects.remove(scene.camera)
            target = EMISSIVE_ROOM.world(1.2, 0.9, -2.0)
            add_camera(EMISSIVE_ROOM.world(-4.2, -3.3, height), target, 24.0, *size)
            bpy.ops.pcc.remove()
            mask, truth = covered(scene, floor), render(scene, samples=256).pixels
            yield [
                f"emissive, {place}",
                name,
                f"{roughness:g}",
                *_errors(scene, truth, mask, 16, place == "eye height"),
            ]


def in_the_lounge() -> Iterator[list[str]]:
    """Rows of the table of the furnished room, with lamps and things that stand in it."""
    for name, roughness in _floors():
        scene = two_rooms(roughness)
        scene.render.resolution_x, scene.render.resolution_y = 120, 68
        _make_floor(bpy.data.materials["Tiles"], name, roughness)
        for probe in _probes(scene):
            probe.resolution, probe.samples = 256, 32
        mask, truth = pixels_of(scene, TWO), render(scene, samples=768).pixels
        bpy.ops.pcc.bake(scope="ALL")
        yield ["furnished", name, f"{roughness:g}", *_errors(scene, truth, mask, 96, False)]


def _floors() -> Iterator[tuple[str, float]]:
    yield from ((name, roughness) for name in LOBES for roughness in (0.1, 0.2, 0.3, 0.45, 0.6))


def _make_floor(material: bpy.types.Material, name: str, roughness: float) -> None:
    inputs = principled_node(material).inputs
    metallic = float(name == "metal")
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = metallic, roughness
    inputs["Base Color"].default_value = (0.8 * metallic,) * 3 + (1.0,)


def _probes(scene: bpy.types.Scene) -> list[bpy.types.PropertyGroup]:
    return [item.pcc_probe for item in scene.objects if item.pcc_probe.is_probe]


def _harden(scene: bpy.types.Scene, value: bool) -> None:
    for probe in _probes(scene):
        probe.contact_hardening = value


def _errors(scene: bpy.types.Scene, truth: np.ndarray, mask: np.ndarray, samples: int, eevee: bool) -> list[str]:
    found = []
    with along_the_mirrored_view():
        bpy.ops.pcc.inject()
        found.append(relative_rmse(render(scene, samples=samples).pixels, truth, mask))
        bpy.ops.pcc.remove()
    bpy.ops.pcc.inject()
    found.append(relative_rmse(render(scene, samples=samples).pixels, truth, mask))
    _harden(scene, True)
    found.append(relative_rmse(render(scene, samples=samples).pixels, truth, mask))
    words = [f"{error:.3f}" for error in found]
    words.append(f"{relative_rmse(render(scene, Engine.EEVEE, 4).pixels, truth, mask):.3f}" if eevee else "")
    _harden(scene, False)
    return words


def cost() -> list[str]:
    """Processor time of a frame that is nothing but a floor of roughness 0.3, over that along the mirrored view."""
    scene = emissive_room()
    _make_floor(bpy.data.objects["Wall -Z"].data.materials[0], "dielectric", 0.3)
    probe = add_room_probe(EMISSIVE_ROOM).pcc_probe
    probe.samples, probe.denoise, probe.resolution = 4, False, 256
    bpy.ops.pcc.bake(scope="ALL")
    seconds: dict[str, list[float]] = {}
    for _ in range(8):
        bpy.ops.pcc.remove()
        with along_the_mirrored_view():
            bpy.ops.pcc.inject()
            seconds.setdefault("mirrored", []).append(render(scene, samples=48).seconds)
            bpy.ops.pcc.remove()
        for name, hardening in (("chosen", False), ("hardening", True)):
            _harden(scene, hardening)
            bpy.ops.pcc.inject()
            seconds.setdefault(name, []).append(render(scene, samples=48).seconds)
        _harden(scene, False)
    plain = median(seconds["mirrored"][1:])
    return [f"{median(seconds[name][1:]) / plain:.2f}" for name in ("chosen", "hardening")]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        by_roughness, by_angle = offline()
        chosen, hardening = cost()
        rows = [*in_the_emissive_room(), *in_the_lounge()]
    head = ["room, camera", "floor", "roughness", "mirrored view", "chosen", "chosen, hardening", "the same, EEVEE"]
    text = (
        "A level is the capture blurred by a lobe that is seen head-on. Half of a lobe that is seen at a grazing angle "
        "would lie below the surface, so its light comes from nearer to the normal than the mirrored view.\n\n"
        f"Relative RMSE against the integral over the GGX lobe (height-correlated Smith masking, {GRID**2} visible "
        "normals), with the box correction, on the floor and 0.7 m above it, seven angles from 2° to 58° above the "
        "surface. The room is the emissive one of checkered walls, or one of 5 × 5 × 2.6 m with plain walls and two "
        "lamps of 0.5 and 0.7 m in its ceiling. A metal's facets reflect alike at all angles here, a dielectric's (IOR "
        "1.5) by Fresnel's curve, so that more of its light comes from grazing ones. The mixtures of normal and "
        "mirrored view are those of Lagarde and de Rousiers (*Moving Frostbite to PBR*, 2014), by the roughness and by "
        "alpha. The mean direction is exact, halfway to it the shader's fit.\n\n"
        "With *Contact Hardening* the roughness of the level is that of the surface times √(distance from the surface "
        "÷ distance from the capture point), 0.35 to 1.5.\n\n"
        f"{by_roughness}\n\nBy the angle, at roughness 0.45:\n\n{by_angle}\n\n"
        "## Rendered\n\n"
        "Against path tracing, 256 px faces, over the pixels of the floor; shown by Cycles unless it says otherwise. "
        "The furnished room is the lounge of `sample_blends/two_rooms.py`: what stands in it is not on the walls of "
        "its box, and no direction or level can make up for that.\n\n"
        f"{table(head, rows)}\n\n"
        f"A frame that shows nothing but a floor of roughness 0.3 takes {chosen} times as long as one along the "
        f"mirrored view, with contact hardening {hardening} times (Cycles, medians of 7). A mirror costs what it did."
    )
    write_page("lobe_shape.md", "The shape of rough lobes", "python3 dev.py run benchmarks/lobe_shape.py", text)


if __name__ == "__main__":
    main()
