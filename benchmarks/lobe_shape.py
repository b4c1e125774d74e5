"""Where a rough surface looks its probe up, and at which level: against the integral over its lobe, and path tracing.

python3 dev.py run benchmarks/lobe_shape.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from unittest.mock import patch

import bpy
import numpy as np

from benchmarks.measure import covered, relative_rmse, render, start, table, write_page
from pcc_addon.core import equirect
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dominant import dominant
from pcc_addon.core.effects.fresnel import MIRRORS, Facets, dielectric_facets
from pcc_addon.core.effects.lobe import mean_tilt
from pcc_addon.core.effects.surface import REFLECTED, SurfaceEffects
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

HALF = np.array(EMISSIVE_ROOM.half_extents)
CAPTURE = np.array([0.0, 0.0, -0.35])
FLOORS = (((0.0, 0.0, 0.0),) * 2, ((0.5, 0.45, 0.4), (0.15, 0.13, 0.12)))  # as captures show a metal's, and a checkered
ROUGHNESSES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
COSINES = (0.04, 0.08, 0.15, 0.25, 0.4, 0.6, 0.85)
POINTS, HEIGHT, GRID = 40, 256, 64
LOBES = {"metal": MIRRORS, "dielectric": dielectric_facets(1.5)}
PLACES = {  # bounds of the points, metres from the room's centre
    "floor": ((-4.8, -3.8, -2.0), (4.8, 3.8, -2.0)),
    "table, 1 m high": ((-4.8, -3.8, -1.0), (4.8, 3.8, -1.0)),
    "floor within 1 m of a wall": ((4.0, -3.8, -2.0), (4.95, 3.8, -2.0)),
}
Colors = tuple[tuple[float, ...], tuple[float, ...]]


def radiance(points: np.ndarray, ways: np.ndarray, floor: Colors) -> tuple[np.ndarray, np.ndarray]:
    """What rays (…, 3) from within the emissive room meet: (…, 3), exactly; and how far away, (…,) metres."""
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = np.where(ways != 0.0, (HALF * np.sign(ways) - points) / ways, np.inf)
    axis = np.maximum(distances, 0.0).argmin(-1)
    far = np.maximum(np.take_along_axis(distances, axis[..., None], -1), 0.0)
    hit = points + far * ways
    seen = np.zeros(hit.shape)
    for side, colors in {**EMISSIVE_COLORS, "-Z": floor}.items():
        k = "XYZ".index(side[1])
        here = (axis == k) & ((ways[..., k] > 0.0) == (side[0] == "+"))
        odd = np.floor(np.delete(hit[here], k, -1)).sum(-1) % 2
        seen[here] = np.where(odd[:, None], colors[1], colors[0])
    return seen, far[..., 0]


def capture(floor: Colors) -> np.ndarray:
    """(h, 2h, 3): the picture from the capture point, three rays squared a texel."""
    ways = equirect.directions(6 * HEIGHT, 3 * HEIGHT)
    seen, _ = radiance(np.broadcast_to(CAPTURE, ways.shape), ways, floor)
    return seen.reshape(HEIGHT, 3, 2 * HEIGHT, 3, 3).mean((1, 3))


@dataclass(frozen=True)
class Views:
    """Points in the room that are seen under one angle.

    Attributes:
        points: (n, 3) metres.
        turns: (n, 3, 3) from the frame of the lobe's samples to the room.
        cosine, roughness: of all of them.
        facets: of the lobe.
        floor: what the floor shows.
    """

    points: np.ndarray
    turns: np.ndarray
    cosine: float
    roughness: float
    facets: Facets
    floor: Colors

    @classmethod
    def some(
        cls, place: str, cosine: float, roughness: float, facets: Facets, floor: Colors, rng: np.random.Generator
    ) -> Views:
        azimuth = rng.uniform(0.0, 2.0 * np.pi, POINTS)
        turns = np.zeros((POINTS, 3, 3))
        turns[:, 0, 0] = turns[:, 1, 1] = np.cos(azimuth)
        turns[:, 1, 0] = np.sin(azimuth)
        turns[:, 0, 1] = -turns[:, 1, 0]
        turns[:, 2, 2] = 1.0
        return cls(rng.uniform(*PLACES[place], (POINTS, 3)), turns, cosine, roughness, facets, floor)

    def truth(self) -> np.ndarray:
        """(n, 3): the mean over the lobe, as a white one would reflect it."""
        facet, ways, leaving = reflected_samples(self.cosine, self.roughness, GRID)
        weight = leaving * self.facets.curve(facet)
        ways, weight = ways[weight > 0.0], weight[weight > 0.0]
        seen, _ = radiance(self.points[:, None], ways @ self.turns.transpose(0, 2, 1), self.floor)
        return (seen * weight[:, None]).sum(1) / weight.sum()

    def hits(self, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3) from the capture point to what a way in the lobe's frame meets, (n,) how far from the surface."""
        ways = self.turns @ way
        far = radiance(self.points, ways, self.floor)[1]
        return self.points + far[:, None] * ways - CAPTURE, far


def mixed_levels(levels: list[np.ndarray], ways: np.ndarray, roughness: np.ndarray) -> np.ndarray:
    """(n, 3): what a ladder of levels shows along directions, each at its roughness."""
    place = np.interp(roughness, LADDER, np.arange(len(LADDER)))
    seen = np.array([equirect.lookup(level, ways) for level in levels])
    share = np.maximum(1.0 - np.abs(place[None] - np.arange(len(LADDER))[:, None]), 0.0)
    return (share[..., None] * seen).sum(0)


def tilted(cosine: float, tilt: float) -> np.ndarray:
    """The mirrored view, brought nearer to the normal by an angle in radians."""
    angle = np.arccos(cosine) - tilt
    return np.array([-np.sin(angle), 0.0, np.cos(angle)])


def leant(cosine: float, share: float) -> np.ndarray:
    """The normal and the mirrored view, mixed."""
    way = share * tilted(cosine, 0.0) + (0.0, 0.0, 1.0 - share)
    return way / np.linalg.norm(way)


def frostbite(roughness: float) -> float:
    """The share of the mirrored view in Lagarde and de Rousiers 2014."""
    return (1.0 - roughness) * (np.sqrt(1.0 - roughness) + roughness)


def shipped(view: Views) -> tuple[np.ndarray, float]:
    """The direction and the level's roughness of this add-on, for a lobe that is alone."""
    incoming = np.array([[np.sqrt(1.0 - view.cosine**2), 0.0, view.cosine]])
    inputs = {"Normal": np.array([[0.0, 0.0, 1.0]]), "Incoming": incoming, "Roughness": view.roughness}
    found = evaluate(dominant((view.facets,)).outputs, inputs, np.float64)
    return found["Direction"][0], float(np.ravel(found["Roughness"])[0])


Way = Callable[[Views], tuple[np.ndarray, float]]
WAYS: dict[str, Way] = {
    "mirrored view": lambda v: (tilted(v.cosine, 0.0), v.roughness),
    "lerp(N, R), roughness": lambda v: (leant(v.cosine, frostbite(v.roughness)), v.roughness),
    "lerp(N, R), alpha": lambda v: (leant(v.cosine, frostbite(v.roughness**2)), v.roughness),
    "mean direction": lambda v: (tilted(v.cosine, mean_tilt(v.cosine, v.roughness, v.facets)), v.roughness),
    "0.85 of the way to it": lambda v: (shipped(v)[0], v.roughness),
    "and a narrower level (chosen)": shipped,
}


def offline() -> tuple[str, str]:
    """The tables by roughness and by angle."""
    rng = np.random.default_rng(3)
    levels = [[prefilter(capture(floor), rung) for rung in LADDER] for floor in FLOORS]
    found: dict[tuple[str, float, float], list[np.ndarray]] = {}
    for name, facets in LOBES.items():
        for roughness in ROUGHNESSES:
            for cosine in COSINES:
                for place in PLACES:
                    for floor, ladder in zip(FLOORS, levels, strict=True):
                        view = Views.some(place, cosine, roughness, facets, floor, rng)
                        errors = _squares(view, ladder)
                        found.setdefault((name, roughness, cosine), []).append(errors)
    by_roughness = [
        [name, f"{roughness:g}", *_mean([e for key, e in found.items() if key[:2] == (name, roughness)])]
        for name in LOBES
        for roughness in ROUGHNESSES
    ]
    by_angle = [
        [name, f"{90.0 - np.degrees(np.arccos(cosine)):.0f}°", *_mean([found[name, 0.4, cosine]])]
        for name in LOBES
        for cosine in COSINES
    ]
    return table(["lobe", "roughness", *WAYS], by_roughness), table(["lobe", "above the surface", *WAYS], by_angle)


def _squares(view: Views, ladder: list[np.ndarray]) -> np.ndarray:
    truth = view.truth()
    found = []
    for way in WAYS.values():
        direction, roughness = way(view)
        ways, _ = view.hits(direction)
        seen = mixed_levels(ladder, ways, np.full(POINTS, roughness))
        found.append(np.square(seen - truth).mean() / np.square(truth).mean())
    return np.array(found)


def _mean(errors: list[list[np.ndarray]]) -> list[str]:
    return [f"{value:.3f}" for value in np.sqrt(np.concatenate(errors).mean(0))]


CAMERAS = {"from eye height": (0.0, -2.0), "low": (-1.6, -2.0)}  # metres from the centre: the camera's and its target's


@contextmanager
def along_the_mirrored_view() -> Iterator[None]:
    """While this lasts, twins are built as if every surface were looked up along the mirrored view."""
    with patch.object(SurfaceEffects, "_reflected", (REFLECTED,)):
        yield


def rendered() -> str:
    """The table of the emissive room with a rough floor against path tracing."""
    rows = []
    for metallic, name in ((1.0, "metal"), (0.0, "dielectric")):
        for roughness in (0.1, 0.2, 0.3, 0.45, 0.6):
            scene = emissive_room()
            floor = bpy.data.objects["Wall -Z"]
            inputs = principled_node(floor.data.materials[0]).inputs
            inputs["Metallic"].default_value, inputs["Roughness"].default_value = metallic, roughness
            inputs["Base Color"].default_value = (0.8 * metallic,) * 3 + (1.0,)
            probe = add_room_probe(EMISSIVE_ROOM, tuple(CAPTURE)).pcc_probe
            probe.samples, probe.denoise, probe.resolution = 16, False, 256
            bpy.ops.pcc.bake(scope="ALL")
            for place, (height, target) in CAMERAS.items():
                rows.append([name, f"{roughness:g}", place, *_rendered(scene, floor, height, target)])
    return table(["floor", "roughness", "camera", "mirrored view", "chosen, Cycles", "chosen, EEVEE"], rows)


def _rendered(scene: bpy.types.Scene, floor: bpy.types.Object, height: float, target: float) -> list[str]:
    bpy.data.objects.remove(scene.camera)
    add_camera(EMISSIVE_ROOM.world(-4.2, -3.3, height), EMISSIVE_ROOM.world(1.2, 0.9, target), 24.0, 240, 135)
    bpy.ops.pcc.remove()
    mask, truth = covered(scene, floor), render(scene, samples=256).pixels
    with along_the_mirrored_view():
        bpy.ops.pcc.inject()
        errors = [relative_rmse(render(scene, samples=16).pixels, truth, mask)]
        bpy.ops.pcc.remove()
    bpy.ops.pcc.inject()
    errors += [relative_rmse(render(scene, engine, 16).pixels, truth, mask) for engine in Engine]
    return [f"{error:.3f}" for error in errors]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        by_roughness, by_angle = offline()
        pictures = rendered()
    half = " × ".join(f"{2 * h:g}" for h in EMISSIVE_ROOM.half_extents)
    text = (
        "A level is the capture blurred by the lobe that is seen head-on, which has one roughness and is round. A "
        "lobe that is seen at a grazing angle is neither: half of it would lie below the surface, so its light comes "
        "from nearer to the normal than the mirrored view, and it is narrower across the plane of view and normal "
        "than along it.\n\n"
        f"Relative RMSE in the emissive room ({half} m, checkered glowing walls) against the integral over the GGX "
        f"lobe (height-correlated Smith masking, {GRID**2} visible normals), with the box correction: on the floor, on "
        "a table 1 m high and within a metre of a wall; the floor black, as captures show a metal's, and checkered; "
        "seven angles from 2° to 58° above the surface. A metal's facets reflect alike at all angles here, a "
        "dielectric's (IOR 1.5) by Fresnel's curve, so that more of its light comes from grazing ones. The mixtures "
        "of normal and mirrored view are those of Lagarde and de Rousiers (*Moving Frostbite to PBR*, 2014), by the "
        "roughness and by alpha. The mean direction is exact, 0.85 of the way to it the shader's fit.\n\n"
        f"{by_roughness}\n\nBy the angle, at roughness 0.4:\n\n{by_angle}\n\n"
        "## Rendered\n\n"
        "The floor of the emissive room, 256 px faces, against the path-traced picture (256 samples); a camera at eye "
        f"height and one 0.4 m above the floor:\n\n{pictures}"
    )
    write_page("lobe_shape.md", "The shape of rough lobes", "python3 dev.py run benchmarks/lobe_shape.py", text)


if __name__ == "__main__":
    main()
