"""What the gallery shows: for each system of docs/systems.md a small scene, and what it is without the system."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

import bpy

from benchmarks import doorway, interior, lobe_shape, thin_film
from benchmarks import gallery_scenes as scenes
from sample_blends import by_hand, glass
from sample_blends.scenes import EMISSIVE_ROOM, Room, gallery


@dataclass(frozen=True)
class System:
    """One strip of the gallery.

    Attributes:
        title: as docs/systems.md calls the system.
        name: of the strip's file.
        sample: the file the scene comes from.
        words: what is to be seen.
        build: makes the scene, unbaked.
        compared: names of the objects whose pixels count.
        lacking: what the third picture has instead.
        without: makes it so, after the bake; may bake again.
        bake: bakes.
        traced: the scene as the path tracer is to see it, meanwhile.
        lacked: what holds while the third picture is made.
        noisy: samples of the second and third picture where these are to keep their noise.
    """

    title: str
    name: str
    sample: str
    words: str
    build: Callable[[], object]
    compared: tuple[str, ...]
    lacking: str = "without correction"
    without: Callable[[], None] = lambda: scenes.uncorrected()
    bake: Callable[[], object] = lambda: bpy.ops.pcc.bake(scope="ALL")
    traced: Callable[[], AbstractContextManager[object]] = nullcontext
    lacked: Callable[[], AbstractContextManager[object]] = nullcontext
    noisy: int | None = None


SYSTEMS = (
    System(
        "classic reflection, the baseline",
        "classic",
        "any_cubemap.py",
        "A mirror ball under a sky, captured from the world: what is far away needs no correction, and a box would put "
        "the sky on its walls.",
        scenes.sky,
        ("Ball",),
        "with a box",
        scenes.corrected,
    ),
    System(
        "inside-box intersection, any box",
        "inside_box",
        "scenes.py",
        "A mirror floor: each wall's reflection meets the wall. The floor itself is matt and grey in captures, as "
        "metals are, and the picture's outermost texels mix it in: a faint line along the foot of the dark squares.",
        scenes.mirror_floor,
        ("Wall -Z",),
    ),
    System(
        "outside test, what is shown there",
        "outside",
        "two_rooms.py",
        "The lounge's probe alone, on a floor that runs through the doorway: beyond it the floor keeps its own lobe. "
        "Before it the floor shows the study as the lounge's middle sees it, as if painted on the opening.",
        scenes.doorway_lounge,
        ("Floor",),
        "without the test",
        scenes.everywhere,
        scenes.already,
    ),
    System(
        "padding",
        "padding",
        "scenes.py",
        "A box that is askew, so that half of the floor is up to 8 mm below it: within the padding of 10 mm it "
        "is still inside.",
        scenes.box_askew,
        ("Wall -Z",),
        "without padding",
        scenes.unpadded,
    ),
    System(
        "capture point apart from the box's centre",
        "capture_point",
        "scenes.py",
        "Captured 2 m aside and 0.5 m below the middle of the room.",
        lambda: scenes.mirror_floor(EMISSIVE_ROOM, (2.0, -1.0, -0.5)),
        ("Wall -Z",),
        "counted from the centre",
        scenes.captured_in_the_centre,
    ),
    System(
        "captures without reflections, with lamps",
        "lamps",
        "scenes.py",
        "The panels on the ceiling are seen in the polished floor, as reflection rays see them. What stands "
        "in the room is shown as if it were painted on the walls.",
        gallery,
        ("Wall -Z",),
        "captured without lamps",
        scenes.lamps_lost,
    ),
    System(
        "metals in captures",
        "metals",
        "two_rooms.py",
        "The mirror in the furnished room; the shelves that it shows are of steel. Captures see metals matt, in half "
        "their colour. The table is left out: off the walls it would be shown lying on the floor.",
        scenes.mirrored_steel,
        ("Lounge Mirror",),
        "metals black in captures",
        scenes.metals_black,
    ),
    System(
        "boxes along the axes, the cheaper case",
        "along_axes",
        "scenes.py",
        "The same room along the world's axes.",
        lambda: scenes.mirror_floor(Room((5.0, 4.0, 2.0), (12.0, -7.0, 2.0), 0.0)),
        ("Wall -Z",),
    ),
    System(
        "any cubemap in any box",
        "any_cubemap",
        "any_cubemap.py",
        "The probe has a file, a cross; the path tracer sees walls that are painted with it.",
        scenes.picture_from_elsewhere,
        ("Ball",),
    ),
    System(
        "several probes, blended",
        "several",
        "two_rooms.py",
        "The same doorway, each side with its room's probe.",
        lambda: doorway.build(scenes.LIT_FACE),
        ("Floor",),
        "the lounge's alone",
        scenes.lounge_alone,
        scenes.already,
    ),
    System(
        "roughness",
        "roughness",
        "two_rooms.py",
        "A floor of roughness 0.22.",
        scenes.rough_floor,
        ("Lounge -Z",),
        "the sharp picture",
        scenes.sharp_picture,
    ),
    System(
        "rough lobes at grazing angles",
        "grazing",
        "scenes.py",
        "A metal floor of roughness 0.45, seen from 0.4 m above it: half of its lobe would be below the floor, so its "
        "light comes from nearer to the normal.",
        scenes.low_over_rough_metal,
        ("Wall -Z",),
        "along the mirrored view",
        bpy.ops.pcc.remove,
        lacked=lobe_shape.along_the_mirrored_view,
    ),
    System(
        "contact hardening",
        "contact_hardening",
        "scenes.py",
        "A floor of roughness 0.3: walls are sharp at their foot and blurred farther up.",
        scenes.hardening_floor,
        ("Wall -Z",),
        "without hardening",
        scenes.not_hardened,
    ),
    System(
        "anisotropy",
        "anisotropy",
        "scenes.py",
        "A ball of brushed metal, which stretches the picture of a lamp. The floor that it shows lacks its shadow, as "
        "the ball is hidden from the capture.",
        scenes.brushed_ball,
        ("Sphere",),
        "rough alike all around",
        scenes.brushed_no_more,
    ),
    System(
        "thin films",
        "thin_film",
        "scenes.py",
        "A dark floor under a film, from 100 nm on the left to 800 nm on the right.",
        lambda: thin_film.film_room("dielectric", 0.0),
        ("Wall -Z",),
        "without the film",
        thin_film.without_film,
    ),
    System(
        "perturbed normals",
        "normals",
        "scenes.py",
        "The mirror floor with waves.",
        scenes.waves,
        ("Wall -Z",),
        "the flat normal",
        scenes.flat_normal,
    ),
    System(
        "oriented and sheared boxes",
        "sheared",
        "any_cubemap.py",
        "A ball in a room that leans.",
        scenes.leaning_room,
        ("Ball",),
        "a box without shear",
        scenes.right_angled,
    ),
    System(
        "interior mapping",
        "interior",
        "interior.py",
        "Flat panes show one baked room; the path tracer sees such a room behind each.",
        interior.furnished_house,
        ("Far Panes",),
        "the picture flat on the pane",
        scenes.flat_panes,
        lambda: interior.show_rooms(scenes.LIT_FACE, 32),
        scenes.real_rooms,
    ),
    System(
        "six-face capture",
        "six_faces",
        "any_cubemap.py",
        "The same ball in walls that are there, captured: no letter is mirrored, no face turned.",
        scenes.painted_walls,
        ("Ball",),
    ),
    System(
        "update only when needed",
        "update",
        "moving.py",
        "Frame 20 of the moving room, with the picture of that frame. The floor lacks the ball, which is hidden from "
        "the room's probe.",
        scenes.moving_room,
        ("Ball", "Wall -Z"),
        "the picture of frame 1",
        scenes.still_of_the_start,
        lambda: bpy.ops.pcc.bake(scope="ALL", frames="1-20:19"),
    ),
    System(
        "reflection, refraction, Fresnel, diffuse",
        "glass",
        "glass.py",
        "A ball, an egg and a pane of glass.",
        glass.glass,
        ("Ball", "Egg", "Pane"),
    ),
    System(
        "the result in each engine, EEVEE's ray tracing",
        "engines",
        "scenes.py",
        "A metal floor of roughness 0.3 in a small room with a lamp; EEVEE's own ray tracing is on. The floor shows "
        "the same picture in both; the walls are EEVEE's own, without light from wall to wall. The pale seam is the "
        "floor, matt in the capture, which the lobe mixes in.",
        scenes.metal_under_a_lamp,
        ("Wall -Z",),
        "the probe in EEVEE",
        scenes.in_eevee,
    ),
    System(
        "which rays see the probe, fireflies",
        "noise",
        "two_rooms.py",
        "Eight samples a pixel in the second and third picture, not denoised: on the floor the probe has less noise. "
        "Paths that left a diffuse surface meet the floor's own lobe, so the walls have the noise that they had.",
        scenes.without_mirrors,
        ("Lounge -Z",),
        "path-traced with as many samples",
        lambda: doorway.show(()),
        noisy=8,
    ),
    System(
        "no self image: hidden and followed objects",
        "no_self_image",
        "any_cubemap.py",
        "The ball stands before the capture point and is hidden from it; otherwise it would reflect itself, matt as "
        "metals are in captures.",
        scenes.captured_from_behind,
        ("Ball",),
        "the ball in the capture",
        scenes.with_itself,
    ),
    System(
        "probes in shaders made by hand",
        "by_hand",
        "by_hand.py",
        "An iridescent shader that tints what a probe's node gives, beside a toon shader and a mirror in mist that no "
        "path tracer makes.",
        lambda: by_hand.by_hand(scenes.FACE, scenes.SAMPLES),
        ("Iridescent Ball",),
        bake=scenes.already,
        traced=scenes.glossy_ball,
    ),
)
