"""Keeps shaders right while an artist works: probes that move, copies, deleted probes, edited materials, undo."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

from ..core.decisions import Effect
from ..core.errors import PccError
from ..core.lookup_plan import Receivers, lookup_effects
from ..core.workplace import real
from . import marks, properties, unrecorded
from .listening import listen, stop_listening
from .probes import keep_pictures_found
from .read.probes import all_probes, bake_record, probe_spec
from .shade import by_hand, copies, groups, injection, live, orphaned, probe_group
from .store import leftovers
from .store.levels import bake_folder, find_again

_paused = 0


@contextlib.contextmanager
def paused() -> Iterator[None]:
    """Nothing is brought up to date meanwhile: a bake changes materials for a while and brings them back itself."""
    global _paused
    _paused += 1
    try:
        yield
    finally:
        _paused -= 1


def is_paused() -> bool:
    """Whether materials are changed for a while, as they are by a bake."""
    return _paused > 0


@bpy.app.handlers.persistent
def on_depsgraph_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Bring up to date what has changed. Animation does not call this: `ProbeSpec.effects` knows of it."""
    if _paused:
        return
    unrecorded.settle()
    with unrecorded.following():
        _follow_changes(scene, depsgraph)


def _follow_changes(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    changed = {update.id.original for update in depsgraph.updates}
    for item in changed:
        if isinstance(item, bpy.types.Object) and item.pcc_probe.is_probe and not item.library:
            _follow(item, scene.pcc.roughness_limit)
    if any(isinstance(item, bpy.types.Scene) for item in changed):  # whatever is deleted changes it
        _let_go_of_deleted()
        if orphaned.groups():
            bring_all_up_to_date(scene)
            return
    materials = {item for item in changed if isinstance(item, bpy.types.Material)}
    trees = {item for item in changed if isinstance(item, bpy.types.ShaderNodeTree) and not marks.role(item)}
    edited = any(isinstance(item, bpy.types.Action) for item in changed)  # its keyframes may be those of inputs
    if edited or any(not tree.is_embedded_data for tree in trees):
        materials.update(bpy.data.materials)
    if materials:
        edited_ones = sorted(materials, key=lambda m: m.name_full)
        live.follow(edited_ones, scene.pcc.roughness_limit, make_levels=True)


@bpy.app.handlers.persistent
def on_undo(scene: bpy.types.Scene, *_: object) -> None:
    """Undo steps are taken before twins follow an edit."""
    unrecorded.remember_addresses()
    with unrecorded.following():
        _place_probes()
        _find_lost_pictures()
        _renew_groups(probe_group.known_receivers)
        for probe in all_probes(scene):
            _follow(probe, scene.pcc.roughness_limit)
        with paused(), contextlib.suppress(PccError):  # status names what is wrong
            injection.show_again(scene, bpy.context.view_layer, orphaned.came_back(scene))
        bring_all_up_to_date(scene)
        for material in [m for m in bpy.data.materials if m.session_uid in _standing_in]:
            with paused(), contextlib.suppress(PccError):  # an injection names what is wrong
                injection.show_anew(scene, bpy.context.view_layer, material)
    _standing_in.clear()


_standing_in: set[int] = set()  # session uids of materials that objects wear instead of copies which no undo step had


@bpy.app.handlers.persistent
def before_undo(*_: object) -> None:
    """What no undo step has would be gone, and still be pointed to."""
    with paused():
        _standing_in.update(material.session_uid for material in unrecorded.let_go(marks.original))


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    """The file may have been edited where the add-on is not, or saved by an older version."""
    leftovers.opened()
    unrecorded.forget()
    orphaned.forget()
    _place_probes()
    for scene in bpy.data.scenes:
        for probe in all_probes(scene):
            probe_group.recall_group(probe)
    _renew_groups(lambda _: probe_group.UNKNOWN_RECEIVERS)  # all twins are brought up to date below
    with paused():
        injection.mend(bpy.context.scene, bpy.context.view_layer)
        bring_all_up_to_date(bpy.context.scene)
        groups.drop_unused_groups()
        bpy.context.view_layer.update()  # these were no edits, for which levels would be made


def _find_lost_pictures() -> None:
    for scene in bpy.data.scenes:
        for probe in all_probes(scene):
            if any(level.image is None for level in probe.pcc_probe.levels):
                with contextlib.suppress(PccError):
                    find_again(probe, bake_folder(scene))


def _renew_groups(receivers_of: Callable[[bpy.types.ShaderNodeTree], Receivers]) -> None:
    """Build the groups of probes again that are not whole, or of another version."""
    for scene in bpy.data.scenes:
        for probe in all_probes(scene):
            group = probe.pcc_probe.group
            with contextlib.suppress(PccError):  # status names what is wrong with the bake
                if (group or probe.pcc_probe.bake_record) and not probe_group.is_current(probe):
                    probe_group.refresh_group(probe, receivers_of(group) if group else probe_group.UNKNOWN_RECEIVERS)
            with contextlib.suppress(PccError):
                if not by_hand.is_current(probe):
                    by_hand.refresh(probe)


def _place_probes() -> None:
    """Let Blender find out where probes are, which it does not know of a file that was just opened."""
    with paused():
        bpy.context.view_layer.update()
        placed = set(bpy.context.view_layer.objects)
        for scene in bpy.data.scenes:
            if not placed.issuperset(all_probes(scene)):
                scene.view_layers[0].update()


@bpy.app.handlers.persistent
def on_close(*_: object) -> None:
    leftovers.closing()


@bpy.app.handlers.persistent
def before_save(path: str, *_: object) -> None:
    """Pictures that are named from the file's folder are still found from another."""
    if path:
        keep_pictures_found(real(path).parent)


@bpy.app.handlers.persistent
def on_save(path: str, *_: object) -> None:
    """Pictures that the saved file shows no more can go."""
    if path:
        leftovers.after_save(Path(path))


def on_shader_setting(probe: bpy.types.Object) -> None:
    """Show a changed setting at once in the materials that show the probe."""
    with contextlib.suppress(PccError):  # a faulty transform is reported when the probe is baked
        live.refresh_probe(probe, bpy.context.scene.pcc.roughness_limit)


def on_effect(owner: bpy.types.ID, effect: Effect | None) -> None:
    """Show at once what an artist chose; choices do not tag what has them."""
    if _paused:
        return
    scene = bpy.context.scene
    if effect is None:
        _show_chosen(owner)
    elif isinstance(owner, bpy.types.Material):
        original = marks.original(owner)
        with paused():
            copies.repeat_choice(owner, original, effect)
        if effect in _DIVIDING:
            with paused(), contextlib.suppress(PccError):  # an injection names what is wrong
                injection.show_anew(scene, bpy.context.view_layer, original)
        live.follow([original], scene.pcc.roughness_limit, make_levels=True)
    elif owner.pcc_probe.group is not None:
        receivers = probe_group.known_receivers(owner.pcc_probe.group)
        with contextlib.suppress(PccError):  # as for a setting
            live.refresh_probe(owner, scene.pcc.roughness_limit, receivers)


def _show_chosen(owner: bpy.types.Material | bpy.types.Object) -> None:
    """Show a material or an object with the probes that were chosen for it."""
    with paused(), contextlib.suppress(PccError):  # an injection names what is wrong
        if isinstance(owner, bpy.types.Material):
            original = marks.original(owner)
            copies.repeat_chosen_probes(owner, original)
            owner = original
        injection.show_anew(bpy.context.scene, bpy.context.view_layer, owner)


_DIVIDING = {Effect.BY_PLACE, Effect.OWN_LOBE}  # they decide which probes a material shows, and whether it shows any


def bring_all_up_to_date(scene: bpy.types.Scene) -> None:
    """Every material that shows probes."""
    _let_go_of_deleted()
    orphaned.note()
    live.follow(list(bpy.data.materials), scene.pcc.roughness_limit)


def _let_go_of_deleted() -> None:
    """Take deleted probes off the materials that chose them, which would keep them and their pictures in the file."""
    for material in bpy.data.materials:
        chosen = material.pcc.probe
        if chosen is not None and not (chosen.library or material.library or chosen.users_collection):
            with paused():
                material.pcc.probe = None
            if not chosen.users:
                bpy.data.objects.remove(chosen)


def _follow(probe: bpy.types.Object, roughness_limit: float) -> None:
    """Give a probe that was moved the lookup that holds wherever it is now, and a copied one a group of its own.

    Drivers follow the box; what they cannot follow is that it was unrotated, held all surfaces or was captured from its
    centre, and how far from the origin it stands. The next injection specialises it again.
    """
    tree = probe.pcc_probe.group
    if tree is None:
        return
    copied = probe_group.probe_of(tree) not in (None, probe)
    if not copied and not probe_group.was_moved(probe):
        return
    try:
        record, spec = bake_record(probe), probe_spec(probe)
        if record is None:
            return
        captured_at = record.capture_point_apart_from(spec.box.centre)
        needed = lookup_effects(
            spec, probe_group.UNKNOWN_RECEIVERS, captured_at, record.source, record.departs_from(spec.box)
        )
        if copied or probe_group.shown_effects(tree) != needed.label:
            live.refresh_probe(probe, roughness_limit)
        else:
            for group in (tree, *by_hand.groups_of(probe)):
                probe_group.follow_afar(group, spec)
    except PccError:  # a transform in passing, such as a scale of 0; the bake reports one that stays
        return


_HANDLERS = (
    ("depsgraph_update_post", on_depsgraph_update),
    ("undo_pre", before_undo),
    ("redo_pre", before_undo),
    ("undo_post", on_undo),
    ("redo_post", on_undo),
    ("load_pre", on_close),
    ("load_post", on_load),
    ("save_pre", before_save),
    ("save_post", on_save),
)


def register() -> None:
    listen(_HANDLERS)
    properties.shader_listeners.append(on_shader_setting)
    properties.effect_listeners.append(on_effect)


def unregister() -> None:
    stop_listening(_HANDLERS)
    properties.shader_listeners.remove(on_shader_setting)
    properties.effect_listeners.remove(on_effect)
    leftovers.closing()
