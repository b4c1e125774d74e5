"""The shaders of exports: HLSL is compiled, run, and finds what NumPy finds; GLSL is valid."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.backends.glsl import identifier
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.export import lookup
from pcc_addon.core.export.shader import shader
from pcc_addon.core.export.targets import TARGETS, target_of
from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import Box, ProbeSpec
from tests.core.boxes import directions

NEEDS_COMPILER = pytest.mark.skipif(
    not shutil.which("glslangValidator"), reason="needs glslangValidator (Debian: glslang-tools)"
)
CAPTURED_AT = (4.2, -2.0, 1.1)
SPECS = {
    "plain": {},
    "black, hardening": {"outside": Outside.BLACK, "contact_hardening": True},
    "faces differ": {"influence": Influence((0.1, 0.2, 0.0), (0.0, 0.3, -0.1), normal_fade=0.2, weight=0.8)},
}


def a_probe(**more: object) -> ProbeSpec:
    matrix = np.eye(4)
    turned, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    matrix[:3, :3], matrix[:3, 3] = turned * (3.0, 2.0, 1.5), (4.0, -2.0, 1.0)
    return ProbeSpec("Hall", Box.from_matrix("Hall", matrix), **more)


def text_of(key: str, spec: ProbeSpec) -> str:
    target = target_of(key)
    of = lookup.formula(lookup.effects_of(spec, CAPTURED_AT), target.roughnesses(64))
    return shader(of, lookup.numbers(spec, CAPTURED_AT, target), target, "A probe")


def compiled(command: list[str | Path]) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@NEEDS_COMPILER
@pytest.mark.parametrize("version", ["330 core", "300 es"])
@pytest.mark.parametrize("spec", SPECS)
@pytest.mark.parametrize("key", [t.key for t in TARGETS if t.language.suffix == "glsl"])
def test_glsl_is_valid(tmp_path: Path, key: str, spec: str, version: str) -> None:
    head = f"#version {version}\nprecision highp float;\nprecision highp samplerCube;\nuniform samplerCube levels;\n"
    main = "out vec4 c;\nvoid main() { c = parallax_probe(levels, vec3(0.1), vec3(0, 0, 1), vec3(0, 0, 1), 0.2); }\n"
    path = tmp_path / "probe.frag"
    path.write_text(head + text_of(key, a_probe(**SPECS[spec])) + main)
    compiled(["glslangValidator", path])


@NEEDS_COMPILER
@pytest.mark.skipif(not shutil.which("spirv-cross"), reason="needs spirv-cross (Debian: spirv-cross)")
@pytest.mark.parametrize("spec", SPECS)
@pytest.mark.parametrize("key", ["unity", "unreal"])
def test_hlsl_finds_what_numpy_finds(tmp_path: Path, key: str, spec: str) -> None:
    """It is run as the GLSL that it is translated to."""
    moderngl = pytest.importorskip("moderngl", reason="needs moderngl")
    probe, target = a_probe(**SPECS[spec]), target_of(key)
    of = lookup.formula(lookup.effects_of(probe, CAPTURED_AT), target.roughnesses(64))
    given = {"Position": "p", "Incoming": "e", "Normal": "n", "Roughness": "r"}
    arguments = ", ".join(given.get(name, f"pp_{identifier(name)}") for name in of.inputs)
    source = f"""{text_of(key, probe)}
        TextureCube levels; SamplerState levels_sampler;
        struct Found {{ float4 place : SV_Position; float3 direction : TEXCOORD0; float3 rest : TEXCOORD1; }};
        Found main(float3 p : POSITION, float3 e : TEXCOORD0, float3 n : NORMAL, float r : TEXCOORD1) {{
            Found found; float level; float brightness; float weight;
            found.place = parallax_probe(levels, levels_sampler, p, e, n, r);
            {identifier(lookup.TITLE)}({arguments}, found.direction, level, brightness, weight);
            found.rest = float3(level, brightness, weight);
            return found;
        }}"""
    (tmp_path / "probe.vert.hlsl").write_text(source)
    compiled(
        [
            "glslangValidator",
            "-D",
            "-V",
            "-S",
            "vert",
            "-e",
            "main",
            tmp_path / "probe.vert.hlsl",
            "-o",
            tmp_path / "spv",
        ]
    )
    done = subprocess.run(
        ["spirv-cross", tmp_path / "spv", "--version", "330", "--no-es"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    names = re.findall(r"^(?:layout\(.*?\) )?out vec3 (\w+);", done.stdout, re.M)
    places = dict(re.findall(r"^layout\(location = (\d)\) in \w+ (\w+);", done.stdout, re.M))
    try:
        context = moderngl.create_standalone_context(backend="egl")
    except Exception as error:  # the drivers of this machine decide which
        pytest.skip(f"no OpenGL here: {error}")
    context.simple_framebuffer((4, 4)).use()
    program = context.program(vertex_shader=done.stdout, varyings=names)
    rng, count = np.random.default_rng(5), 500
    points = probe.box.centre + rng.uniform(-1.1, 1.1, (count, 3)) @ probe.box.axes.T
    surface = {
        "Position": target.units * points @ target.axes.matrix.T,
        "Incoming": directions(count, rng),
        "Normal": directions(count, rng),
        "Roughness": rng.random((count, 1)),
    }
    data = np.ascontiguousarray(np.concatenate(list(surface.values()), 1), np.float32)
    attributes = [places[str(k)] for k in range(4)]
    vertices = context.vertex_array(program, [(context.buffer(data.tobytes()), "3f 3f 3f 1f", *attributes)])
    result = context.buffer(reserve=4 * count * 6)
    vertices.transform(result, moderngl.POINTS, count)
    found = np.frombuffer(result.read(), np.float32).reshape(count, 6)
    context.release()
    numbers = {name: np.array(value) for name, value in lookup.numbers(probe, CAPTURED_AT, target).items()}
    surface["Roughness"] = surface["Roughness"][:, 0]
    expected = evaluate(of.outputs, {name: np.float32(v) for name, v in (surface | numbers).items()}, np.float32)
    np.testing.assert_allclose(found[:, :3], expected["Direction"], rtol=1e-3, atol=1e-3)
    for k, name in enumerate(("Level", "Brightness", "Weight")):
        np.testing.assert_allclose(found[:, 3 + k], np.broadcast_to(expected[name], count), atol=2e-3)
