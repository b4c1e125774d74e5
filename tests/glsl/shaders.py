"""Runs printed formulas on arrays, with OpenGL in software where there is no other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pcc_addon.core.backends import glsl
from pcc_addon.core.expression import Formula


def vertex_shader(formula: Formula) -> str:
    """A shader that computes a formula for each vertex and hands its outputs on."""
    name = glsl.identifier
    kinds = {1: "float", 3: "vec3"}
    samplers = glsl.samplers(formula)
    head = [f"in {kinds[part.width]} {name(n)};" for n, part in formula.inputs.items()]
    head += [f"uniform sampler2D {name(n)};" for n in samplers]
    head += [f"out {kinds[e.width]} out_{name(n)};" for n, e in formula.outputs.items()]
    arguments = [*map(name, formula.inputs), *map(name, samplers), *(f"out_{name(n)}" for n in formula.outputs)]
    call = f"void main() {{ {name(formula.title)}({', '.join(arguments)}); gl_Position = vec4(0.0); }}"
    return "\n".join([glsl.PRELUDE, glsl.functions(formula), *head, call, ""])


def run(
    formula: Formula, inputs: Mapping[str, np.ndarray], pictures: Mapping[str, np.ndarray] | None = None
) -> dict[str, np.ndarray]:
    """Like `arrays.evaluate` in float32, by a graphics driver.

    Raises:
        ImportError: moderngl is missing.
        Exception: whatever moderngl raises where no OpenGL can be had.
    """
    import moderngl

    context = moderngl.create_standalone_context(backend="egl")
    context.simple_framebuffer((4, 4)).use()  # without one nothing is drawn, not even into buffers
    outputs = {f"out_{glsl.identifier(n)}": e.width for n, e in formula.outputs.items()}
    shader = "#version 330\n" + vertex_shader(formula)
    program = context.program(vertex_shader=shader, varyings=list(outputs))
    for unit, (name, picture) in enumerate((pictures or {}).items()):
        height, width = picture.shape[:2]
        texture = context.texture(
            (width, height), picture.shape[2], np.ascontiguousarray(picture, np.float32).tobytes(), dtype="f4"
        )
        texture.repeat_x, texture.repeat_y = True, False
        texture.use(unit)
        program[glsl.identifier(name)] = unit
    used = {n: part for n, part in formula.inputs.items() if glsl.identifier(n) in program}
    columns = [np.asarray(inputs[n], np.float32).reshape(-1, part.width) for n, part in used.items()]
    count = max(len(column) for column in columns)
    data = np.concatenate([np.broadcast_to(column, (count, column.shape[1])) for column in columns], 1)
    layout = " ".join(f"{part.width}f" for part in used.values())
    attributes = [glsl.identifier(n) for n in used]
    buffer = context.buffer(np.ascontiguousarray(data, np.float32).tobytes())
    vertices = context.vertex_array(program, [(buffer, layout, *attributes)])
    result = context.buffer(reserve=4 * count * sum(outputs.values()))
    vertices.transform(result, moderngl.POINTS, count)
    found = np.frombuffer(result.read(), np.float32).reshape(count, -1)
    context.release()
    parts = np.split(found, np.cumsum(list(outputs.values()))[:-1], axis=1)
    return {n: p if p.shape[1] == 3 else p[:, 0] for n, p in zip(formula.outputs, parts, strict=True)}
