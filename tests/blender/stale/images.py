"""Images and files."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, fresh, stale
from tests.blender.stale.things import (
    generated,
    geometry_nodes,
    group,
    keyed,
    node,
    picture,
    scene,
    surface,
    texture,
    the,
    tree,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@stale("image", "its pixels")
def _(folder: Path) -> Steps:
    made = texture(folder)
    yield
    made.pixels[0] = 0.75


@stale("image", "the file, of the same size and name")
def _(folder: Path) -> Steps:
    texture(folder)
    yield
    before = (folder / "picture.png").stat()
    data = (folder / "picture.png").read_bytes()
    picture(folder, value=0.25)
    changed = (folder / "picture.png").read_bytes()
    assert changed != data
    os.utime(folder / "picture.png", ns=(before.st_atime_ns, before.st_mtime_ns + 1))


@stale("image", "its file is gone")
def _(folder: Path) -> Steps:
    texture(folder)
    yield
    (folder / "picture.png").unlink()


@stale("image", "its colour space")
def _(folder: Path) -> Steps:
    made = texture(folder)
    yield
    made.colorspace_settings.name = "Non-Color"


@stale("image", "how its alpha is read")
def _(folder: Path) -> Steps:
    made = texture(folder)
    yield
    made.alpha_mode = "NONE"


@stale("image", "another one in the node")
def _(folder: Path) -> Steps:
    texture(folder)
    other = bpy.data.images.load(str(picture(folder, "other", 0.1)))
    yield
    next(n for n in tree().nodes if n.bl_idname == "ShaderNodeTexImage").image = other


@stale("image", "the colour of a generated one")
def _(folder: Path) -> Steps:
    made = generated()
    yield
    made.generated_color = (1.0, 0.0, 0.0, 1.0)


@stale("image", "the pattern of a generated one")
def _(folder: Path) -> Steps:
    made = generated()
    yield
    made.generated_type = "UV_GRID"


@stale("image", "the pixels of a generated one")
def _(folder: Path) -> Steps:
    made = generated()
    yield
    made.pixels[5] = 0.5


@stale("image", "the pixels of a packed one")
def _(folder: Path) -> Steps:
    made = texture(folder)
    made.pack()
    yield
    made.pixels[0] = 0.75
    made.pack()


@stale("image", "the file of a tile")
def _(folder: Path) -> Steps:
    for number in (1001, 1002):
        picture(folder, f"tiles.{number}")
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(folder / "tiles.1001.png"))
    made.image.source = "TILED"
    made.image.filepath = str(folder / "tiles.<UDIM>.png")
    if 1002 not in [tile.number for tile in made.image.tiles]:
        made.image.tiles.new(1002)
    yield
    picture(folder, "tiles.1002", 0.25)


@stale("image", "the file of a sequence")
def _(folder: Path) -> Steps:
    picture(folder, "frame0001")
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(folder / "frame0001.png"))
    made.image.source = "SEQUENCE"
    made.image_user.frame_duration = 1
    yield
    picture(folder, "frame0001", 0.25)


@stale("image", "the offset of a sequence")
def _(folder: Path) -> Steps:
    picture(folder, "frame0001"), picture(folder, "frame0002", 0.1)
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(folder / "frame0001.png"))
    made.image.source = "SEQUENCE"
    made.image_user.frame_duration = 2
    yield
    made.image_user.frame_offset = 1


@fresh("image", "the frame, where a film stands at its last picture")
def _(folder: Path) -> Steps:
    picture(folder, "frame0001"), picture(folder, "frame0002", 0.1)
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(folder / "frame0001.png"))
    made.image.source = "SEQUENCE"
    made.image_user.frame_duration = 2
    scene().frame_set(10)
    yield
    scene().frame_set(20)


@stale("image", "the frame, where a film is shown")
def _(folder: Path) -> Steps:
    picture(folder, "frame0001")
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(folder / "frame0001.png"))
    made.image.source = "SEQUENCE"
    yield
    scene().frame_set(scene().frame_current + 1)


@fresh("image", "packed")
def _(folder: Path) -> Steps:
    made = texture(folder)
    yield
    made.pack()


@fresh("image", "one that nobody shows, and other unused data")
def _(folder: Path) -> Steps:
    yield
    for kind in ("images", "meshes", "lights", "node_groups", "curves", "texts"):
        arguments = {
            "images": (4, 4), "lights": ("POINT",), "node_groups": ("ShaderNodeTree",), "curves": ("CURVE",),
        }.get(kind, ())  # fmt: skip
        getattr(bpy.data, kind).new("Unused", *arguments).use_fake_user = True


@fresh("image", "the file written again as it was")
def _(folder: Path) -> Steps:
    texture(folder)
    yield
    data = (folder / "picture.png").read_bytes()
    (folder / "picture.png").unlink()
    (folder / "picture.png").write_bytes(data)


@fresh("file", "saved and opened again")
def _(folder: Path) -> Steps:
    group(), keyed(), geometry_nodes(the())
    generated()
    yield
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "scene.blend"))


@fresh("file", "moved with its textures to another folder")
def _(folder: Path) -> Steps:
    (folder / "here").mkdir()
    made = texture(folder / "here")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "here" / "scene.blend"))
    made.filepath = "//picture.png"
    bpy.ops.wm.save_mainfile()
    yield
    shutil.move(folder / "here", folder / "there")
    bpy.ops.wm.open_mainfile(filepath=str(folder / "there" / "scene.blend"))


@fresh("file", "something undone")
def _(folder: Path) -> Steps:
    bpy.ops.ed.undo_push(message="before")
    yield
    the().location.x += 1.0
    surface().inputs["Roughness"].default_value = 0.9
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()


@fresh("file", "something changed and changed back")
def _(folder: Path) -> Steps:
    yield
    x = the().location.x
    the().location.x = 3.0
    bpy.context.view_layer.update()
    the().location.x = x
