"""The second tables of docs/numerics.md: what is seen through glass, shares, levels, dominant directions.

python3 dev.py run benchmarks/conformance.py
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from benchmarks.measure import ROOT, start, table, write_between
from pcc_addon.core.backends.arrays import evaluate
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
    parts = [f"Blender {bpy.app.version_string}.", _through_glass(judged)]
    parts += [_of_kind(kind, judged) for kind in ("shares", "levels", "dominant direction")]
    head = ["", "bound", "bound ≤ it", "NumPy", "Cycles", "GLSL", "EEVEE"]
    parts.append(table(head, [_group_row(name, group, judged) for name, group in _groups()]))
    parts.append(f"Parts and own lobe add up to 1 to {_largest_sum():.2f} of 4 ulp a probe.")
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


def _group_row(name: str, group: list[Subject], judged: dict[str, Verdict]) -> list[str]:
    """How often the bound is as small as is promised, and the largest error over its bound, by what ran it."""
    promised = np.concatenate([judged[str(s)].bound_at_most(s.promised) for s in group]).mean()
    row = [name, f"{group[0].promised:.0e}", f"{promised:.0%}"]
    numpy, glsl, eevee = 0.0, 0.0, 0.0
    for subject in group:
        cases, _ = subject.together(CASES)
        numpy = max(numpy, _share(subject.judge(cases, evaluate(subject.formula.outputs, cases.inputs()))))
        glsl = max(glsl, _share(subject.judge(cases, shaders.run(subject.formula, cases.inputs()))))
        if len(subject.formula.inputs) <= MOST_IN_EEVEE:
            eevee = max(eevee, _share(judged_in_eevee(subject, subject.together(EEVEE_CASES)[0])))
    cycles = max(_share(judged[str(s)]) for s in group)
    return row + [f"{share:.2f}" for share in (numpy, cycles, glsl, eevee)]


def _share(verdict: Verdict) -> float:
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
