"""Panes and what one puts on them: new panes, rooms from files, window materials on objects."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from ..core import room_map
from ..core.effects.interior import RoomPicture
from ..core.errors import PccError
from ..core.room_map import Corner
from .shade.interior import RoomImage


def open_picture(path: str) -> bpy.types.Image:
    """The picture in a file, in the file's own colour space.

    Raises:
        PccError: there is none.
    """
    try:
        image = bpy.data.images.load(bpy.path.abspath(path), check_existing=True)
    except RuntimeError as error:
        raise PccError(f"picture '{path}' cannot be read; choose another ({str(error).strip()})") from error
    if not all(image.size):
        bpy.data.images.remove(image)
        raise PccError(f"picture '{path}' cannot be read; choose another")
    return image


def equirectangular_room(path: str) -> RoomImage:
    """The room of an equirectangular picture, whose middle shows the back wall.

    Raises:
        PccError: it is missing or has another shape.
    """
    image = open_picture(path)
    width, height = image.size
    if width != 2 * height:
        raise PccError(
            f"picture '{image.name}' of {width} × {height} pixels is not equirectangular: that is twice as wide as high"
        )
    return RoomImage(RoomPicture(rows=height), image)


def unfolded_room(path: str) -> RoomImage:
    """The room of a room map; its equirectangular picture is packed into the .blend.

    Raises:
        PccError: it is missing or no room map.
    """
    source = open_picture(path)
    room_map.check_room_map(source.name, *source.size)
    pixels = room_map.equirectangular(_pixels(source))
    pixels[..., 3] = 1.0
    return RoomImage(RoomPicture(rows=len(pixels)), _new_image(f"{Path(path).stem} room", pixels, source))


def layer(path: str, corner: Corner | None = None) -> bpy.types.Image:
    """A flat picture with alpha; with a corner, that tile of a room map, packed.

    Raises:
        PccError: it is missing or no room map.
    """
    source = open_picture(path)
    if corner is None:
        return source
    room_map.check_room_map(source.name, *source.size)
    return _new_image(f"{Path(path).stem} {corner.value}", room_map.corner(_pixels(source), corner), source)


def _pixels(image: bpy.types.Image) -> np.ndarray:
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)


def _new_image(name: str, pixels: np.ndarray, like: bpy.types.Image) -> bpy.types.Image:
    """A packed image with the colour space and depth of another."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=like.is_float)
    image.colorspace_settings.name = like.colorspace_settings.name
    image.alpha_mode = like.alpha_mode
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    image.update()
    image.pack()
    return image


def add_pane(
    collection: bpy.types.Collection, name: str, place: Matrix, width: float, height: float
) -> bpy.types.Object:
    """A new upright pane in metres that is seen from its −Y side; the place is its middle."""
    x, z = width / 2.0, height / 2.0
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-x, 0.0, -z), (x, 0.0, -z), (x, 0.0, z), (-x, 0.0, z)], [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="UVMap").uv
    for corner, at in zip(uv, ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)), strict=True):
        corner.vector = at
    pane = bpy.data.objects.new(name, mesh)
    pane.matrix_world = place
    collection.objects.link(pane)
    return pane


def lies_flat(mesh: bpy.types.Mesh) -> bool:
    """Whether most of a mesh faces up or down in its own axes, as Blender's planes do before they are turned."""
    weights = [(abs(polygon.normal.z), polygon.area) for polygon in mesh.polygons]
    area = sum(area for _, area in weights)
    return area > 0.0 and sum(z * area for z, area in weights) > 0.7071 * area


def put_on(material: bpy.types.Material, objects: Iterable[bpy.types.Object]) -> None:
    """Give objects a material in their active slot; a material that nothing else uses any more stays in the file."""
    for item in objects:
        before = item.active_material
        item.active_material = material
        if before is not None and before.users == 0:
            before.use_fake_user = True
