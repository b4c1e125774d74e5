"""The second tables of docs/numerics.md: what is seen through glass, shares, levels, dominant directions.

python3 dev.py run benchmarks/conformance.py
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import bpy
import numpy as np

from benchmarks.measure import ROOT, start, table, write_between
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.expression import Formula
from tests.conformance import sharing
from tests.conformance.run import MOST_IN_EEVEE, in_cycles, judged_in_eevee
from tests.conformance.subjects import SUBJECTS, Subject
from tests.conformance.verdict import Verdict
from tests.glsl import shaders

CASES, EEVEE_CASES = 2048, 256  # of a family and a formula
PAGE = ROOT / "docs" / "numerics.md"
GLASS = ("thin pane", "one interface", "solid")


def main() -> None:
    start()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    judged = {str(s): s.judge(*_run(s)) for s in SUBJECTS}
    shares = {"Cycles": {name: _share(verdict) for name, verdict in judged.items()}}
    small = [s for s in SUBJECTS if len(s.formula.inputs) <= MOST_IN_EEVEE]
    shares["EEVEE"] = {str(s): _share(judged_in_eevee(s, s.together(EEVEE_CASES)[0])) for s in small}
    largest_sum = _largest_sum()
    # Last: other contexts of OpenGL come between Blender and its own.
    shares["GLSL"] = {str(s): _share_of(s, shaders.run) for s in SUBJECTS}
    shares["NumPy"] = {
        str(s): _share_of(s, lambda formula, inputs: evaluate(formula.outputs, inputs)) for s in SUBJECTS
    }

    parts = [f"Blender {bpy.app.version_string}.", _through_glass(judged)]
    parts += [_of_kind(kind, judged) for kind in ("shares", "levels", "dominant direction")]
    engines = ("NumPy", "Cycles", "GLSL", "EEVEE")
    rows = []
    for name, group in _groups():
        promised = np.concatenate([judged[str(s)].bound_at_most(s.promised) for s in group]).mean()
        most = [max(shares[engine].get(str(s), 0.0) for s in group) for engine in engines]
        rows.append([name, f"{group[0].promised:.0e}", f"{promised:.0%}", *(f"{share:.2f}" for share in most)])
    parts.append(table(["", "bound", "bound ≤ it", *engines], rows))
    parts.append(f"Parts and own lobe add up to 1 to {largest_sum:.2f} of 4 ulp a probe.")
    write_between(PAGE, "tables: written by benchmarks/conformance.py", "\n\n".join(parts))


def _run(subject: Subject) -> tuple:
    cases, _ = subject.together(CASES)
    return cases, in_cycles(subject.formula.outputs, cases.inputs())


def _groups() -> Iterator[tuple[str, list[Subject]]]:
    for interface in GLASS:
        yield f"seen through, {interface}", [s for s in SUBJECTS if s.name.startswith(interface)]
    for kind in ("shares", "levels", "dominant direction"):
        yield kind, [s for s in SUBJECTS if s.kind == kind]


def _through_glass(judged: dict[str, Verdict]) -> str:
    """Largest error in Cycles, radians, and the largest error over its bound."""
    groups = [(interface, [s for s in SUBJECTS if s.name.startswith(interface)]) for interface in GLASS]
    rows = []
    for k, name in enumerate(groups[0][1][0].families.names):
        cells = [_worst([judged[str(s)] for s in group], k) for _, group in groups]
        rows.append([name, *(f"{error:.1e}, {share:.2f}" for error, _, share in cells)])
    return table(["seen through", *GLASS], rows)


def _of_kind(kind: str, judged: dict[str, Verdict]) -> str:
    group = [s for s in SUBJECTS if s.kind == kind]
    rows = []
    for k, name in enumerate(group[0].families.names):
        error, bound, share = _worst([judged[str(s)] for s in group], k)
        rows.append([name, f"{error:.1e}", f"{bound:.1e}", f"{share:.2f}"])
    return table([kind, "largest error", "its bound", "error ÷ bound"], rows)


def _worst(verdicts: list[Verdict], family: int) -> tuple[float, float, float]:
    """The largest error of a family, its bound, and the largest error over its bound."""
    part = slice(family * CASES, (family + 1) * CASES)
    error, bound = (np.concatenate([getattr(v, n)[part].ravel() for v in verdicts]) for n in ("error", "bound"))
    worst = error.argmax()
    return float(error[worst]), float(bound[worst]), float((error / bound).max())


def _share_of(subject: Subject, run: Callable[[Formula, Mapping[str, np.ndarray]], Mapping[str, np.ndarray]]) -> float:
    cases, _ = subject.together(CASES)
    return _share(subject.judge(cases, run(subject.formula, cases.inputs())))


def _share(verdict: Verdict) -> float:
    """The largest error over its bound."""
    assert verdict.finite.all()
    return float((verdict.error / verdict.bound).max())


def _largest_sum() -> float:
    """How far parts and own lobe add up from 1 in Cycles, over what they may."""
    most = 0.0
    for subject in (s for s in SUBJECTS if s.kind == "shares"):
        _, found = _run(subject)
        total = sharing.parts_of(found).astype(np.float64).sum(-1)
        most = max(most, float(np.abs(total - 1.0).max() / sharing.sum_bound(sharing.PROBES)))
    return most


if __name__ == "__main__":
    main()
