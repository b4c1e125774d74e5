"""A capture is the right way round: marks that break every symmetry of a room are found where they should be."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.core import equirect
from sample_blends.scenes import Room, add_wall
from tests.blender.helpers import bake, glow, picture, small_probe

ROOM = Room((3.0, 2.5, 2.0), (-4.0, 7.0, 1.5), 0.6)
_BRIGHT = 4.0
# For each wall: its own glow, and where its mark is (fractions of the half extents), with the mark's colour.
WALLS = {
    "+X": ((0.10, 0.20, 0.30), (1.0, 0.5, 0.25), (1.0, 0.0, 0.0)),
    "-X": ((0.30, 0.20, 0.10), (-1.0, 0.4, -0.5), (0.0, 1.0, 0.0)),
    "+Y": ((0.20, 0.30, 0.10), (-0.6, 1.0, 0.3), (0.0, 0.0, 1.0)),
    "-Y": ((0.10, 0.30, 0.20), (-0.3, -1.0, -0.5), (1.0, 1.0, 0.0)),
    "+Z": ((0.30, 0.10, 0.20), (0.5, -0.2, 1.0), (0.0, 1.0, 1.0)),
    "-Z": ((0.20, 0.10, 0.30), (0.2, 0.6, -1.0), (1.0, 0.0, 1.0)),
}


def build_room() -> dict[str, Vector]:
    """The room with its marks; their centres in world space by wall."""
    centres = {}
    for side, (own, place, color) in WALLS.items():
        add_wall(ROOM, side, glow(f"Wall {side}", own))
        axis = "XYZ".index(side[1])
        local = Vector(p * h for p, h in zip(place, ROOM.half_extents, strict=True))
        local[axis] *= 0.995  # just in front of the wall
        u, v = (Vector(np.eye(3)[k]) * 0.15 for k in range(3) if k != axis)
        mesh = bpy.data.meshes.new(f"Mark {side}")
        mesh.from_pydata([local - u - v, local + u - v, local + u + v, local - u + v], [], [(0, 1, 2, 3)])
        mesh.materials.append(glow(f"Mark {side}", [_BRIGHT * c for c in color]))
        mark = bpy.data.objects.new(f"Mark {side}", mesh)
        mark.matrix_world = ROOM.matrix
        bpy.context.scene.collection.objects.link(mark)
        centres[side] = ROOM.matrix @ local
    return centres


def centroid(image: np.ndarray, color: np.ndarray) -> np.ndarray:
    """The mean world-space direction of the pixels of a mark's colour, a unit vector."""
    height, width = image.shape[:2]
    weight = np.clip(1.0 - np.abs(image - color).max(-1) / (0.5 * _BRIGHT), 0.0, None)
    weight *= equirect.solid_angles(width, height)[:, None]
    total = (equirect.directions(width, height) * weight[..., None]).sum((0, 1))
    assert weight.sum() > 0.0, "the mark is not in the picture"
    return total / np.linalg.norm(total)


def check_marks(engine: str) -> None:
    """Every mark of a captured room is where its position says, within a texel and a half."""
    centres = build_room()
    turn = ROOM.matrix.to_euler()
    probe = small_probe("Probe", ROOM.centre, ROOM.half_extents, turn, (0.8, -0.6, 0.4))
    probe.pcc_probe.resolution, probe.pcc_probe.engine = 64, engine
    [result] = bake(probe)
    assert result.error is None
    image, spec = picture(probe), probe_spec(probe)
    assert image.shape == (128, 256, 3)
    capture_point = ROOM.matrix @ Vector((0.8, -0.6, 0.4))
    assert np.allclose(spec.capture_point, capture_point, atol=1e-5)
    texel = 2.0 * np.pi / 256
    for side, (own, _, color) in WALLS.items():
        towards = np.array((centres[side] - capture_point).normalized())
        found = centroid(image, _BRIGHT * np.array(color))
        angle = np.arccos(np.clip(found @ towards, -1.0, 1.0))
        assert angle < 1.5 * texel, f"the mark on {side} is {angle / texel:.1f} texels off"
        u, v = equirect.coordinates(towards)
        texture = image[int(v * 128), int(u * 256)]
        assert np.allclose(texture, _BRIGHT * np.array(color), atol=0.05), f"{texture} at the mark on {side}"
        opposite = ROOM.matrix.to_3x3() @ Vector(WALLS[side][1])
        behind = equirect.lookup(image, np.array(opposite) + 1e-6)
        assert np.isfinite(behind).all() and np.abs(behind).max() > 0.05, "the room is closed"
        normal = np.array(ROOM.matrix.to_3x3() @ Vector(np.sign(np.trunc(WALLS[side][1]))))
        assert np.allclose(equirect.lookup(image, normal), own, atol=0.02), f"the wall {side} has another's colour"


def test_every_mark_is_found_where_its_position_says_with_cycles(scene) -> None:
    check_marks("CYCLES")


@pytest.mark.render
@pytest.mark.heavy
def test_every_mark_is_found_where_its_position_says_with_eevee(scene) -> None:
    check_marks("EEVEE")


def test_the_marks_tell_a_mirrored_picture_apart(scene) -> None:
    centres = build_room()
    probe = small_probe("Probe", ROOM.centre, ROOM.half_extents, (0.0, 0.0, 0.6))
    probe.pcc_probe.resolution = 64
    bake(probe)
    image = picture(probe)
    for wrong in (image[:, ::-1], image[::-1], np.roll(image, 64, 1), image[::-1, ::-1]):
        angles = []
        for side, (_, _, color) in WALLS.items():
            towards = np.array((centres[side] - Matrix.Translation(ROOM.centre).translation).normalized())
            angles.append(np.arccos(np.clip(centroid(wrong, _BRIGHT * np.array(color)) @ towards, -1.0, 1.0)))
        assert max(angles) > 10.0 * 2.0 * np.pi / 256
