"""Pictures on disk and in Blender: linear float EXR, numbers untouched by colour management."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy
import numpy as np

from ...core.errors import BakeError
from ...core.workplace import real
from .. import compat, unrecorded
from ..overrides import temporary


class _Desk:
    """The data blocks that files are read and written through."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack
        self._blank: dict[tuple[int, int], bpy.types.Image] = {}
        self._reader: bpy.types.Image | None = None
        self._plain: bpy.types.Image | None = None
        self._scene: bpy.types.Scene | None = None

    def read(self, path: Path) -> bpy.types.Image:
        """The image of a file, until the next one is read."""
        if self._reader is None:
            self._reader = temporary(self._stack, bpy.data.images, bpy.data.images.load(str(path)))
            self._reader.colorspace_settings.name = "Non-Color"
        elif self._reader.packed_file:  # by "Automatically Pack Resources"; it would go on showing that file
            self._reader.unpack(method="REMOVE")
        self._reader.filepath_raw = str(path)  # which tells nobody: the other way each node of the file is asked
        self._reader.buffers_free()
        return self._reader

    def plain(self, path: Path) -> bpy.types.Image:
        """An image as shaders are to read files, itself never read, of some file."""
        if self._plain is None:
            self._plain = temporary(self._stack, bpy.data.images, bpy.data.images.load(str(path)))
            self._plain.colorspace_settings.name = "Non-Color"
            self._plain.alpha_mode = "NONE"
        return self._plain

    def blank(self, width: int, height: int) -> bpy.types.Image:
        """An image to fill, until the next one of that size is wanted."""
        if (width, height) not in self._blank:
            image = bpy.data.images.new("pcc", width, height, float_buffer=True, is_data=True)
            self._blank[width, height] = temporary(self._stack, bpy.data.images, image)
        return self._blank[width, height]

    def scene(self, half: bool) -> bpy.types.Scene:
        """A scene that writes float EXR files, of 16 or 32 bits."""
        if self._scene is None:
            self._scene = temporary(self._stack, bpy.data.scenes, bpy.data.scenes.new("pcc"))
            compat.set_float_exr(self._scene.render.image_settings)
        self._scene.render.image_settings.color_depth = "16" if half else "32"
        return self._scene


_desk: _Desk | None = None


@contextmanager
def desk() -> Iterator[_Desk]:
    """Read and write all files meanwhile through the same data blocks.

    Each data block that comes or goes makes renderers read the scene anew, and takes longer the more there are.
    """
    global _desk
    if _desk is not None:
        yield _desk
        return
    with ExitStack() as stack:
        _desk = _Desk(stack)
        try:
            yield _desk
        finally:
            _desk = None


def read_pixels(image: bpy.types.Image) -> np.ndarray:
    """(height, width, 3) float32, row 0 at the bottom.

    Raises:
        BakeError: the image has no pixels, as where its file is missing.
    """
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    if len(image.pixels) != len(pixels) or not len(pixels):
        raise BakeError(f"picture '{image.name}' ({image.filepath}) cannot be read; bake its probe again")
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)[..., :3]


def check_pixels(probe: str, image: bpy.types.Image | None) -> int:
    """The rows of a probe's picture.

    Raises:
        BakeError: it is missing or cannot be read, or has no equirectangular shape.
    """
    name = image.name if image else "of a level"
    width, height = image.size if image else (0, 0)
    if not height or width != 2 * height:
        raise BakeError(f"probe '{probe}': its picture '{name}' is missing or cannot be read; bake it again")
    return height


def read_file(path: Path) -> np.ndarray:
    """The pixels of an EXR file, as `read_pixels` gives them."""
    with desk() as at:
        return read_pixels(at.read(path))


def write_file(path: Path, picture: np.ndarray, *, half: bool = False) -> None:
    """Write (height, width, 3) as an EXR of 32-bit floats, losslessly compressed.

    Args:
        path: where to.
        picture: of float32.
        half: whether to write 16-bit floats; the picture must hold nothing else.

    Raises:
        BakeError: the file cannot be written.
    """
    height, width = picture.shape[:2]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = picture
    with desk() as at:
        image = at.blank(width, height)
        image.pixels.foreach_set(pixels.ravel())
        try:
            image.save_render(str(path), scene=at.scene(half))
        except RuntimeError as error:
            raise BakeError(_cannot_write(path, error)) from error
        if not _holds(path, pixels[..., :3]):
            path.unlink(missing_ok=True)
            raise BakeError(_cannot_write(path, "the file came out incomplete"))


def write_radiance(path: Path, picture: np.ndarray) -> None:
    """Write (height, width, 3) float32 as a Radiance HDR file, whose numbers have 8 bits and a common exponent.

    Raises:
        BakeError: the file cannot be written.
    """
    height, width = picture.shape[:2]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = picture
    with ExitStack() as stack:
        image = bpy.data.images.new("pcc", width, height, float_buffer=True, is_data=True)
        temporary(stack, bpy.data.images, image)
        image.pixels.foreach_set(pixels.ravel())
        image.file_format = "HDR"
        try:
            image.save(filepath=str(path))
        except RuntimeError as error:
            raise BakeError(_cannot_write(path, error)) from error
        if not path.is_file():
            raise BakeError(_cannot_write(path, "nothing was written"))


def _cannot_write(path: Path, why: object) -> str:
    return f"cannot write '{path}' ({' '.join(str(why).split())}); free space on the disk or choose another folder"


def _holds(path: Path, picture: np.ndarray) -> bool:
    """Whether a file can be read back as it was meant; a full disk may cut one short without an error."""
    try:
        return path.is_file() and np.array_equal(read_file(path), picture)
    except BakeError:
        return False


def is_whole(path: Path, width: int, height: int) -> bool:
    """Whether an EXR file of a size can be read; before Blender 5.0 one whose end is missing can be."""
    if not path.is_file():
        return False
    with desk() as at:
        return tuple(at.read(path).size) == (width, height)  # that of a file that cannot be read is (0, 0)


def load(path: Path) -> bpy.types.Image:
    """The picture as a new data block for shaders.

    A copy, since Blender goes through all shaders of the file whenever the colour space of an image is set.
    """
    with desk() as at:
        image = unrecorded.new(at.plain(path).copy)
    image.filepath_raw = blend_path(path)
    return image


def pictures_folder(probe: bpy.types.Object) -> Path | None:
    """Where the files of a probe's pictures are, or None where it has none."""
    image = next((level.image for level in probe.pcc_probe.levels if level.image), None)
    if image is None or image.packed_file:
        return None
    return real(bpy.path.abspath(image.filepath)).parent


def blend_path(path: Path) -> str:
    """`path` relative to the .blend where that is saved."""
    if not bpy.data.filepath:
        return str(path)
    try:
        return bpy.path.relpath(str(path))
    except ValueError:  # another drive
        return str(path)
