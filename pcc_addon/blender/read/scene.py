"""What a scene shows, as plain data: placements of objects, their materials, probes. Writes nothing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np

from ...core.effects.kinds import may_transmit
from ...core.errors import PccError
from ...core.probe import Source
from ...core.readings import CameraReading, FacetReading, PlacementReading, ProbeReading, SceneReading, WallReading
from .. import marks
from .facets import FacetReader, is_sharp
from .holders import originals
from .materials import read_material
from .moving import is_animated, is_moving
from .probes import all_probes, bake_record, check_place, probe_spec
from .shown import OtherReaders, other_readers
from .walls import read_wall

_BY_AXES = [0, 1, 3, 2, 4, 5, 7, 6]  # Blender's order of a bounding box's corners as that of `numpy.ndindex`
SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD"}
"""The types of objects that materials cover."""


def read_scene(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> SceneReading:
    """A scene as a render of one view layer shows it."""
    placements, materials = [], {}
    for placement, shown in _placements(view_layer):
        placements.append(placement)
        materials.update({material.name_full: material for material in shown})
    read = tuple(read_material(materials[name]) for name in sorted(materials))
    readers = other_readers()
    sharp = {materials[m.name] for m in read if any(is_sharp(surface) for surface in m.surfaces)}
    probes, copied = all_probes(scene), originals()
    clear = {materials[m.name] for m in read if any(may_transmit(surface) for surface in m.surfaces)}
    return SceneReading(
        name=scene.name,
        probes=tuple(read_probe(probe, view_layer, readers, copied.get(probe.name, "")) for probe in probes),
        materials=read,
        placements=tuple(placements),
        roughness_limit=scene.pcc.roughness_limit,
        cameras=_cameras(scene),
        walls=tuple(_walls(view_layer, clear)) if clear else (),
        facets=tuple(_facets(scene, view_layer, sharp)) if sharp and probes else (),
        animated=frozenset(_moving(scene, view_layer)),
    )


def _cameras(scene: bpy.types.Scene) -> tuple[CameraReading, ...]:
    found = {o.name: o for o in (scene.camera, *(marker.camera for marker in scene.timeline_markers)) if o}
    return tuple(CameraReading(name, _place(found[name], scene)) for name in sorted(found))


def _place(camera: bpy.types.Object, scene: bpy.types.Scene) -> tuple[float, float, float] | None:
    parallel = camera.type == "CAMERA" and camera.data.type == "ORTHO"
    if parallel or is_animated(camera) or scene.render.use_multiview:
        return None
    return tuple(float(c) for c in camera.matrix_world.translation)


def read_probe(
    probe: bpy.types.Object, view_layer: bpy.types.ViewLayer, readers: OtherReaders, copy_of: str = ""
) -> ProbeReading:
    """One probe, which shows the pictures of the one called `copy_of`; what is wrong with it becomes its fault."""
    spec, captured_at, fault, source, over_frames, departure = None, None, "", Source.BAKE, False, None
    try:
        check_place(probe, view_layer)
        spec = probe_spec(probe)
        record = bake_record(probe)
        if record:
            captured_at, source = record.capture_point_apart_from(spec.box.centre), record.source
            over_frames, departure = bool(record.moments), record.departs_from(spec.box)
    except PccError as error:
        fault = str(error)
    by_hand, in_windows = readers.read_by_hand(probe), readers.read_by_windows(probe)
    return ProbeReading(
        probe.name,
        spec,
        fault,
        captured_at,
        source,
        by_hand,
        in_windows,
        over_frames,
        departure,
        probe.pcc_probe.advice,
        copy_of,
    )


def rendered_objects(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[bpy.types.Object]:
    """The objects of a scene, and those that its instances bring in, by name; probes and cameras not excepted."""
    found = {item.name_full: item for item in scene.objects}
    for instance in _depsgraph(view_layer).object_instances:
        original = instance.object.original
        found.setdefault(original.name_full, original)
    return [found[name] for name in sorted(found)]


def missing_textures(view_layer: bpy.types.ViewLayer, world: bpy.types.World | None) -> list[str]:
    """A sentence for each image file that rendered materials or the world need and that is not there."""
    trees = {material.node_tree for _, shown in _placements(view_layer) for material in shown if material.node_tree}
    if world and world.node_tree:
        trees.add(world.node_tree)
    found = []
    for image in sorted({i for tree in trees for i in _images(tree, set())}, key=lambda i: i.name_full):
        path = bpy.path.abspath(image.filepath, library=image.library)
        if image.source == "FILE" and not image.packed_file and not Path(path).is_file():
            found.append(f"image '{image.name}': its file '{path}' is missing; relink it or pack it")
    return found


def painted_images() -> list[str]:
    """A sentence for each image whose newest pixels are in this Blender's memory alone."""
    painted = [
        i for i in bpy.data.images if i.is_dirty and i.source in {"FILE", "GENERATED", "TILED"} and not i.library
    ]
    return [
        f"image '{image.name}' was painted and is not saved: the bake shows it as it was before; save it with Image › "
        "Save, and bake again"
        for image in sorted(painted, key=lambda image: image.name)
    ]


def _placements(view_layer: bpy.types.ViewLayer) -> list[tuple[PlacementReading, list[bpy.types.Material]]]:
    """Every object and instance that a render shows, and its materials; geometry nodes may assign others than slots."""
    found = []
    for evaluated, matrix in _shown(view_layer):
        corners = np.array(evaluated.bound_box, np.float64)[_BY_AXES] @ matrix[:3, :3].T + matrix[:3, 3]
        materials = _materials(evaluated)
        names = tuple(material.name_full for material in materials)
        original = evaluated.original
        fixed, excluded = _is_fixed(original, names), not original.pcc.show_probes
        found.append((PlacementReading(original.name_full, names, corners, fixed, excluded), materials))
    return found


def _walls(view_layer: bpy.types.ViewLayer, clear: set[bpy.types.Material]) -> Iterator[WallReading]:
    """What clear materials cover of each object and instance that a render shows."""
    for evaluated, matrix in _shown(view_layer):
        for material in _materials(evaluated):
            wall = read_wall(evaluated, matrix, material) if material in clear else None
            if wall is not None:
                yield wall


def _facets(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, sharp: set[bpy.types.Material]
) -> Iterator[FacetReading]:
    """What sharp materials cover of each object that is flat."""
    reader = FacetReader(scene, sharp)
    for instance in _shown_instances(view_layer):
        worn = sharp.intersection(_materials(instance.object))
        if worn:
            matrix = np.array(instance.matrix_world, np.float64)
            reader.add(instance.object, matrix, worn, steady=not instance.is_instance)
    return reader.readings()


def _shown(view_layer: bpy.types.ViewLayer) -> Iterator[tuple[bpy.types.Object, np.ndarray]]:
    """The evaluated object and the (4, 4) float64 matrix of everything with a surface that a render shows."""
    for instance in _shown_instances(view_layer):
        yield instance.object, np.array(instance.matrix_world, np.float64)


def _shown_instances(view_layer: bpy.types.ViewLayer) -> Iterator[bpy.types.DepsgraphObjectInstance]:
    for instance in _depsgraph(view_layer).object_instances:
        if instance.object.type in SURFACES and not instance.object.hide_render:
            yield instance


def _moving(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Iterator[str]:
    """Names of what may be elsewhere at another frame: of objects, and of those that moving ones make instances of."""
    known = {item.name_full: is_moving(item) for item in scene.objects}
    yield from (name for name, moves in known.items() if moves)
    for instance in _depsgraph(view_layer).object_instances:
        if instance.is_instance:
            makers = (instance.parent.original, instance.object.original)
            known |= {item.name_full: is_moving(item) for item in makers if item.name_full not in known}
            if any(known[item.name_full] for item in makers):
                yield makers[1].name_full


def _is_fixed(item: bpy.types.Object, shown: tuple[str, ...]) -> bool:
    """Whether an object's materials cannot be exchanged: it is linked, or shows others than those of its slots."""
    own = {marks.original(slot.material).name_full for slot in item.material_slots if slot.material}
    return item.library is not None or item.override_library is not None or not own.issuperset(shown)


def _materials(evaluated: bpy.types.Object) -> list[bpy.types.Material]:
    """The original materials that an evaluated object shows, by name."""
    found = {marks.original(slot.material.original) for slot in evaluated.material_slots if slot.material}
    made = getattr(evaluated.data, "materials", ())
    found |= {marks.original(material.original) for material in made if material}
    return sorted(found, key=lambda m: m.name_full)


def _images(tree: bpy.types.NodeTree, seen: set[str]) -> set[bpy.types.Image]:
    if tree.name_full in seen:
        return set()
    seen.add(tree.name_full)
    found = set()
    for node in tree.nodes:
        if marks.role(node):
            continue
        if getattr(node, "image", None):
            found.add(node.image)
        if getattr(node, "node_tree", None):
            found |= _images(node.node_tree, seen)
    return found


def _depsgraph(view_layer: bpy.types.ViewLayer) -> bpy.types.Depsgraph:
    view_layer.update()  # reading a depsgraph behind the data crashes Blender
    return view_layer.depsgraph
