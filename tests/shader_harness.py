"""Runs a node group on arrays: what Blender's shader nodes really compute, case by case, to compare with NumPy.

Every case is one quad of a grid and one pixel of a picture. Inputs are face attributes, so they reach the shader
without interpolation; the output is emitted, so it reaches the picture without lighting; an orthographic camera and
a pixel filter a hundredth of a pixel wide put each sample in the middle of its quad. Cycles then gives the float32
numbers that its nodes compute, signed. What is not finite arrives as 0: Cycles replaces it in its film.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import ExitStack

import bpy
import numpy as np

from pcc_addon.blender import compat, rendering
from pcc_addon.blender.overrides import temporary
from pcc_addon.blender.shade import groups, node_builder
from pcc_addon.core.expression import Expr
from pcc_addon.core.probe import Engine
from sample_blends.scenes import emissive
from tests.eevee import without_shadows


def evaluate_expressions(
    outputs: Mapping[str, Expr], inputs: Mapping[str, np.ndarray], engine: Engine = Engine.CYCLES
) -> dict[str, np.ndarray]:
    """Emit `outputs` as a node group, run that on `inputs`, and remove it again; see `evaluate_group`."""
    with ExitStack() as stack:
        tree = temporary(stack, bpy.data.node_groups, bpy.data.node_groups.new("harness", "ShaderNodeTree"))
        node_builder.emit(tree, outputs, node_builder.Surroundings(group_of=groups.formula_group))
        return evaluate_group(tree, inputs, engine=engine)


def evaluate_group(
    tree: bpy.types.ShaderNodeTree,
    inputs: Mapping[str, np.ndarray],
    outputs: Iterable[str] | None = None,
    engine: Engine = Engine.CYCLES,
) -> dict[str, np.ndarray]:
    """Run a shader node group on arrays, with Cycles on the CPU or with EEVEE; one render an output.

    Args:
        tree: the group; its sockets are floats, vectors or colours.
        inputs: for at least every input of the group, by name, an array (n,) or (n, 3), or one value for all cases.
        outputs: names of the outputs wanted; None: all.
        engine: EEVEE rounds what it shows to half floats and takes at most about a dozen inputs.

    Returns:
        For each output (n,) float32 for a float socket and (n, 3) float32 otherwise.

    Raises:
        ValueError: no input is an array of cases, or the arrays differ in length.
    """
    sockets = [item for item in tree.interface.items_tree if item.item_type == "SOCKET"]
    wide = {s.name: s.socket_type != "NodeSocketFloat" for s in sockets if s.in_out == "INPUT"}
    arrays = {name: np.asarray(inputs[name], np.float32) for name in wide}
    counts = {len(a) for name, a in arrays.items() if a.ndim == 1 + wide[name]}
    if len(counts) != 1:
        raise ValueError(f"inputs need one common number of cases, not {sorted(counts)}")
    cases = counts.pop()
    names = [s.name for s in sockets if s.in_out == "OUTPUT"] if outputs is None else list(outputs)
    kinds = {s.name: s.socket_type for s in sockets if s.in_out == "OUTPUT"}
    with ExitStack() as stack:
        bench = _Bench(stack, cases, engine)
        group = bench.use_group(tree)
        for name, array in arrays.items():
            shape = (cases, 3) if wide[name] else (cases,)
            bench.feed(group.inputs[name], np.broadcast_to(array, shape))
        found = {}
        for name in names:
            picture = bench.render(group.outputs[name])
            found[name] = picture[:, 0] if kinds[name] == "NodeSocketFloat" else picture
        return found


class _Bench:
    """A scene of its own with the grid of quads and the camera; gone when the stack closes."""

    def __init__(self, stack: ExitStack, cases: int, engine: Engine) -> None:
        self._cases = cases
        self._width = max(int(np.ceil(np.sqrt(cases))), 4)  # Blender renders at least 4×4 pixels
        self._height = max(-(-cases // self._width), 4)
        data = bpy.data
        self._scene = temporary(stack, data.scenes, data.scenes.new("harness"))
        self._material, self._emission = emissive("harness")
        temporary(stack, data.materials, self._material)
        self._mesh = temporary(stack, data.meshes, data.meshes.new("harness"))
        camera = temporary(stack, data.cameras, data.cameras.new("harness"))
        grid = temporary(stack, data.objects, data.objects.new("harness grid", self._mesh))
        eye = temporary(stack, data.objects, data.objects.new("harness eye", camera))
        self._make_grid()
        eye.location = (self._width / 2, self._height / 2, 1.0)
        camera.type, camera.ortho_scale, camera.sensor_fit = "ORTHO", self._width, "HORIZONTAL"
        for item in (grid, eye):
            self._scene.collection.objects.link(item)
        self._scene.camera = eye
        self._set_render(engine)
        self._material.cycles.emission_sampling = "NONE"

    def _nodes(self) -> bpy.types.bpy_prop_collection:
        return self._material.node_tree.nodes

    def _make_grid(self) -> None:
        columns, rows = self._width + 1, self._height + 1
        y, x = np.mgrid[0:rows, 0:columns]
        points = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3).astype(np.float32)
        corner = (y[:-1, :-1] * columns + x[:-1, :-1]).reshape(-1, 1)
        quads = (corner + np.array([0, 1, columns + 1, columns])).astype(np.int32)
        mesh = self._mesh
        mesh.vertices.add(len(points))
        mesh.vertices.foreach_set("co", points.ravel())
        mesh.loops.add(quads.size)
        mesh.loops.foreach_set("vertex_index", quads.ravel())
        mesh.polygons.add(len(quads))
        mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
        mesh.update(calc_edges=True)
        mesh.materials.append(self._material)

    def _set_render(self, engine: Engine) -> None:
        scene = self._scene
        scene.render.engine = compat.engine_id(engine)
        scene.render.filter_size, scene.eevee.taa_render_samples = 0.01, 1
        without_shadows(scene)
        scene.render.resolution_x, scene.render.resolution_y = self._width, self._height
        scene.render.resolution_percentage = 100
        scene.render.dither_intensity = 0.0
        scene.render.use_compositing = scene.render.use_sequencer = False
        cycles = scene.cycles
        cycles.device, cycles.samples, cycles.max_bounces = "CPU", 1, 0
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
        compat.set_float_exr(scene.render.image_settings)

    def use_group(self, tree: bpy.types.ShaderNodeTree) -> bpy.types.ShaderNodeGroup:
        """A node of the group in the grid's material."""
        node = self._nodes().new("ShaderNodeGroup")
        node.node_tree = tree
        return node

    def feed(self, socket: bpy.types.NodeSocket, values: np.ndarray) -> None:
        """Give an input a value a case: (n,) or (n, 3)."""
        name = f"case {len(self._mesh.attributes)}"
        padded = np.zeros((self._width * self._height, 3), np.float32)
        padded[: self._cases] = values.reshape(self._cases, -1)  # a scalar becomes three: "Fac" would average, rounded
        self._mesh.attributes.new(name, "FLOAT_VECTOR", "FACE").data.foreach_set("vector", padded.ravel())
        node = self._nodes().new("ShaderNodeAttribute")
        node.attribute_name = name
        source = node.outputs["Vector"]
        if values.ndim == 1:
            separate = self._nodes().new("ShaderNodeSeparateXYZ")
            self._material.node_tree.links.new(source, separate.inputs[0])
            source = separate.outputs[0]
        self._material.node_tree.links.new(source, socket)

    def render(self, socket: bpy.types.NodeSocket) -> np.ndarray:
        """(n, 3) float32 of what a socket computes."""
        self._material.node_tree.links.new(socket, self._emission.inputs["Color"])
        return rendering.render(self._scene).pixels.reshape(-1, 3)[: self._cases]
