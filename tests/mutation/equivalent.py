"""Changes that no test can notice, because they change nothing that anybody could see."""

from __future__ import annotations

_GROWN = (
    "probe.box.axes * (1.0 + margin / probe.box.half_widths) for probe, margin in zip(probes, margins, strict=True)"
)
_ON, _LIT = "on = nearer > 0.0", "lit = luminance > _DARKEST"
_NEAR = "near = ((lows <= high) & (highs >= low)).all(1).nonzero()[0].tolist()"
_MEAN = "return float(probe.within_influence(points).mean()), float(distances.max(-1).mean())"
_SHARED_DEPTH = "box = Correction.ORIENTED_BOX if effects.correction is Correction.NONE else effects.correction"
_NONE_LEFT = "return replace(shading, reflectance=single, left=shading.left * 0.0)"
_CRITICAL = "return np.where(g2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)"
_SEEN_LOBE = 'return Lobe(Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12)), roughness, distribution)'
_COSINES = "_COSINES = np.concatenate([[0.0002, 0.001, 0.002, 0.004, 0.008], 0.5 - 0.5 * np.cos(_ANGLES), [1.0]])"
_ROUGHNESSES = (
    "_ROUGHNESSES = np.array("
    "[0.01, 0.03, 0.05, 0.08, 0.12, 0.16, 0.2, 0.25, 0.3, 0.36, 0.42, 0.5, 0.6, 0.7, 0.85, 1.0])"
)
_WEIGHT = "weight = weight * np.where(_ROUGHNESS <= _IMPORTANT, 1.0, 0.2)"
_MEANS = "return (tuple(float(k) for k in np.linalg.lstsq(basis, 1.0 - means, rcond=None)[0]),)"
_INNER = "if inner is not None and index < len(inner.inputs):"
_ENGINES = 'for original, engine in zip(originals, ("CYCLES", "EEVEE"), strict=False):'
_SAMPLING = 'if material.cycles.emission_sampling == "NONE":'
_SAME_OUTPUTS = "if tree is None or before in (None, probe_group.outputs(tree)):"
_SHOWN = "if material.node_tree and tree in shown_probe_groups(material):"
_ROW = "result[row] = gain[row] * np.fft.irfft(real + 1j * imaginary, n=width).T"
_CLEANED = (
    "cleaned = np.clip(np.nan_to_num(picture, nan=0.0, posinf=BRIGHTEST, neginf=0.0), 0.0, BRIGHTEST)"
    ".astype(np.float32)"
)
_FACE_OF = "index = 2 * axis + (np.take_along_axis(directions, axis[:, None], -1)[:, 0] < 0)"
_AVERAGES = (
    "def directional_averages("
    "cosines: np.ndarray, roughness: float, curves: Sequence[Curve], grid: int = 96) -> np.ndarray:"
)
_OVER_LOBES = "return np.array([(weights * curve(facets)).mean(-1) for curve in curves])"
_OVER_LOBE = "return np.concatenate([(weights * curve(facets)).mean(-1) for facets, weights in _samples(distribution)])"
_PASSED = "return (weights * (1.0 - fresnel_dielectric(facets, eta))).mean(-1)"
_LEAVES = "return np.where(light_cosine > 0.0, (1.0 + lambda_view) / (1.0 + lambda_view + lambda_light), 0.0)"
_SEEN = "return np.where(light_cosine > 0.0, distribution * masking, 0.0)"
_FACES = 'for axis, row, area in zip("XYZ", _COFACTORS, _AREAS, strict=True)'
_ARGUMENTS = "given = zip(formula.inputs, expr.calls.arguments, strict=True)"
_SINK = 'emitter.layout.add(sink, max(depths, default=0), "")'
_OF_NUMBERS = "elif all(part.width == 1 for part in (expr, *expr.args)):"
_LEFT = 'axes = ", ".join(axis for axis, width in zip("XYZ", left, strict=True) if not width > 0.0)'
_SIDE = "root = sqrt(b * b - 4.0 * a * c) * (minimum(sign(i_x), 0.0) * -2.0 - 1.0)"
_READ = 'return Path(path).read_text(encoding="utf-8").strip()'
_VIEW = (
    'MIRRORED_VIEW = Formula("Mirrored View", '
    '{"Direction": reflect(INCOMING, given_or(NORMAL, SURFACE_NORMAL)) * -1.0})'
)
_STEP = "if self.ior is not None and abs(self.ior - 1.0) < _NO_STEP and shading.film is None:"
_LEAVING = 'leaving = Section("Far side", normalize(AXIS_X * far.x + AXIS_Y * far.y + AXIS_Z * far.z) * -1.0)'
_BOX_AXES = 'axes = dict(zip("XYZ", matrix[:3, :3].T, strict=True))'
_UPRIGHT = 'up = axes["Z"] * (-1.0 if axes["Z"][2] < 0.0 else 1.0)'
_INPUTS = "for old, new in zip(node.inputs, copy.inputs, strict=True):"
_POINTS = "for theirs, ours in zip(curve.keyframe_points, made.keyframe_points, strict=True):"
_PAIRS = "pairs = zip(found, values, strict=True)"
_KEYS = "for level, key in zip(levels, keys, strict=True)"
_MIXED = 'mix = self._new("ShaderNodeMixShader", right=right, row=row)'

EQUIVALENT: dict[tuple[str, str, str, str], str] = {
    ("core/thumbnails.py", _ON, "nearer > 0.0", "nearer >= 0.0"): "no ray meets the very rim",
    ("core/thumbnails.py", _LIT, "luminance > _DARKEST", "luminance >= _DARKEST"): "as good as black",
    ("core/belonging.py", _NEAR, "highs >= low", "highs > low"): "a coarse test before an exact one",
    ("core/belonging.py", _MEAN, "-1", "1"): "the last axis of two",
    ("core/belonging.py", _GROWN, "strict=True", ""): "both are as long",
    ("core/belonging.py", _GROWN, "True", "False"): "both are as long",
    (
        "core/effects/lookup.py", _SHARED_DEPTH,
        "Correction.ORIENTED_BOX if effects.correction is Correction.NONE else effects.correction",
        "effects.correction",
    ): "the same nodes under another title",
    ("core/effects/glossy.py", _NONE_LEFT, "shading.left * 0.0", "shading.left / 0.0"): "nodes divide by 0 to 0",
    ("core/effects/fresnel.py", _CRITICAL, "g2 > 0.0", "g2 >= 0.0"): "at the critical angle both are 1",
    ("core/effects/lobe.py", _COSINES, "0.002", "0.003"): "one of many points of a fit",
    ("core/effects/lobe.py", _ROUGHNESSES, "0.16", ""): "one of many points of a fit",
    ("core/effects/lobe.py", _WEIGHT, "_ROUGHNESS <= _IMPORTANT", "_ROUGHNESS < _IMPORTANT"): "no point lies on it",
    ("core/effects/lobe.py", _OVER_LOBE, "-1", "1"): "the last axis of two",
    ("core/effects/lobe.py", _PASSED, "-1", "1"): "the last axis of two",
    ("core/effects/lobe.py", _MEANS, "rcond=None", ""): "NumPy's own default",
    (
        "blender/read/materials.py", _INNER, "index < len(inner.inputs)", "index <= len(inner.inputs)",
    ): "an output node has one input more than its group has outputs",
    ("blender/shade/twin.py", _ENGINES, "strict=False", ""): "the default",
    ("blender/shade/twin.py", _SAMPLING, "'NONE'", "'NONE?'"): "what is noted is what is set",
    ("blender/shade/live.py", _SAME_OUTPUTS, "None", ""): "before its first group nothing shows a probe",
    (
        "blender/shade/live.py", _SHOWN, "material.node_tree and tree in shown_probe_groups(material)",
        "material.node_tree or tree in shown_probe_groups(material)",
    ): "those without twins are passed over",
    ("core/prefilter.py", _ROW, "n=width", ""): "NumPy's own default: a row has an even number of texels",
    ("core/radiance.py", _CLEANED, "nan=0.0", ""): "NumPy's own default",
    ("core/radiance.py", _CLEANED, "neginf=0.0", ""): "the smallest number is clipped to 0 too",
    ("core/influence.py", _LEFT, "strict=True", ""): "both have three",
    ("core/sequence.py", "Point = tuple[float, float, float]", "float", ""): "an alias for type checkers",
    ("core/workplace.py", _READ, "'utf-8'", "'utf-8?'"): "Python takes it for the same name",
    (
        "core/effects/normal.py", _SIDE,
        "sqrt(b * b - 4.0 * a * c) * (minimum(sign(i_x), 0.0) * -2.0 - 1.0)",
        "sqrt(b * b - 4.0 * a * c) / (minimum(sign(i_x), 0.0) * -2.0 - 1.0)",
    ): "by 1 or -1",
    ("core/effects/dominant.py", _SEEN_LOBE, "1e-12", "1.5e-12"): "as good as 0",
    (
        "core/effects/shading.py", "transmittance: Expr = field(default_factory=lambda: lift(0.0))", "0.0", "1.0",
    ): "nobody reads it before a transmission says what it is",
    (
        "core/effects/by_hand.py", _VIEW,
        "reflect(INCOMING, given_or(NORMAL, SURFACE_NORMAL)) * -1.0",
        "reflect(INCOMING, given_or(NORMAL, SURFACE_NORMAL)) / -1.0",
    ): "by -1",
    (
        "core/effects/transmission.py", _STEP, "abs(self.ior - 1.0) < _NO_STEP", "abs(self.ior - 1.0) <= _NO_STEP",
    ): "no index is just so far from 1",
    (
        "core/effects/transmission.py", _LEAVING,
        "normalize(AXIS_X * far.x + AXIS_Y * far.y + AXIS_Z * far.z) * -1.0",
        "normalize(AXIS_X * far.x + AXIS_Y * far.y + AXIS_Z * far.z) / -1.0",
    ): "by -1",
    ("core/window.py", _BOX_AXES, "strict=True", ""): "both are three",
    (
        "core/window.py", _UPRIGHT,
        "axes['Z'] * (-1.0 if axes['Z'][2] < 0.0 else 1.0)", "axes['Z'] / (-1.0 if axes['Z'][2] < 0.0 else 1.0)",
    ): "by 1 or -1",
    (
        "core/window.py", _UPRIGHT, "axes['Z'][2] < 0.0", "axes['Z'][2] <= 0.0",
    ): "neither end of a level axis is higher",
    ("blender/shade/surface_builder.py", _MIXED, "right=right", ""): "`spread` puts it right of what feeds it anyway",
    ("blender/shade/sketch.py", _INPUTS, "strict=True", ""): "a node's copy has as many inputs",
    ("blender/shade/sketch.py", _INPUTS, "True", "False"): "a node's copy has as many inputs",
    ("blender/shade/animation.py", _POINTS, "strict=True", ""): "as many points were added",
    ("blender/shade/playback.py", _PAIRS, "strict=True", ""): "a value was made for each change",
    ("blender/store/sequences.py", _KEYS, "True", "False"): "a key was made for each",
    ("core/cubemap.py", _FACE_OF, "-1", "1"): "the last axis of two",
    ("core/ggx.py", _AVERAGES, "96", "97"): "as many points of a quadrature",
    ("core/ggx.py", _OVER_LOBES, "-1", "1"): "the last axis of two",
    ("core/ggx.py", _LEAVES, "light_cosine > 0.0", "light_cosine >= 0.0"): "at a right angle all is masked",
    ("core/ggx.py", _SEEN, "light_cosine > 0.0", "light_cosine >= 0.0"): "at a right angle all is masked",
    ("blender/shade/drivers.py", _FACES, "strict=True", ""): "all are as long",
    ("blender/shade/drivers.py", _FACES, "True", "False"): "all are as long",
    ("blender/shade/node_builder.py", _ARGUMENTS, "strict=True", ""): "a call has an argument for each input",
    ("blender/shade/node_builder.py", _ARGUMENTS, "True", "False"): "a call has an argument for each input",
    ("blender/shade/node_builder.py", _SINK, "0", "1"): "where a node stands that is alone",
    ("blender/shade/node_builder.py", _OF_NUMBERS, "expr", ""): "of numbers alone only Combine makes a vector",
}  # fmt: skip
"""Why, by module, source line without its indentation, what was replaced, and by what."""
