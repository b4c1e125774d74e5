"""The mutation tool makes the changes that it says."""

from __future__ import annotations

import ast

import pytest

from .child import PACKAGE
from .equivalent import EQUIVALENT
from .mutants import mutants, mutated, sample
from .suites import SUITES

SOURCE = '''"""A module."""

from __future__ import annotations


def find(items: list[int], limit: int = 3) -> int | None:
    """The first small one."""
    for item in items:
        if item < limit and not item == 0:
            return sorted(items, key=abs)[0] - 1
    raise ValueError("none")
'''


@pytest.mark.parametrize(
    ("kind", "before", "after"),
    [
        ("comparison", "item < limit", "item <= limit"),
        ("comparison", "item == 0", "item != 0"),
        ("and/or", "item < limit and (not item == 0)", "item < limit or not item == 0"),
        ("negation dropped", "not item == 0", "item == 0"),
        ("condition forced", "item < limit and (not item == 0)", "True"),
        ("operator", "sorted(items, key=abs)[0] - 1", "sorted(items, key=abs)[0] + 1"),
        ("argument dropped", "key=abs", ""),
        ("constant", "3", "4"),
        ("constant", "'none'", "'none?'"),
        ("value not returned", "return sorted(items, key=abs)[0] - 1", "return None"),
        ("statement removed", "raise ValueError('none')", "pass"),
    ],
)
def test_a_change_is_made_where_it_says(kind: str, before: str, after: str) -> None:
    [found] = [m for m in mutants(SOURCE) if (m.kind, m.before, m.after) == (kind, before, after)]
    lines, plain = mutated(SOURCE, found.number).splitlines(), ast.unparse(ast.parse(SOURCE)).splitlines()
    [(was, now)] = [pair for pair in zip(plain, lines, strict=True) if pair[0] != pair[1]]
    assert before in was and after in now


def test_every_change_is_a_different_program_that_compiles() -> None:
    texts = [mutated(SOURCE, mutant.number) for mutant in mutants(SOURCE)]
    assert len(set(texts)) == len(texts)
    for text in texts:
        compile(text, "changed", "exec")


def test_annotations_imports_and_docstrings_stay() -> None:
    for mutant in mutants(SOURCE):
        text = mutated(SOURCE, mutant.number)
        assert "items: list[int]" in text and "-> int | None" in text and "The first small one." in text


def test_a_sample_is_spread_over_the_kinds_and_the_same_for_the_same_seed() -> None:
    found = mutants(SOURCE)
    kinds = {mutant.kind for mutant in found}
    few = sample(found, len(kinds), 5)
    assert {mutant.kind for mutant in few} == kinds
    assert few == sample(found, len(kinds), 5)
    assert sample(found, 1000, 5) == found


def test_every_module_and_test_file_that_is_named_exists() -> None:
    named = [
        *(PACKAGE / module for module in SUITES),
        *(PACKAGE.parent / f for files in SUITES.values() for f in files),
    ]
    assert [path for path in named if not path.exists()] == []


def test_every_change_said_to_be_equivalent_is_one_that_is_made() -> None:
    made = {
        (module, source.splitlines()[mutant.line - 1].strip(), mutant.before, mutant.after)
        for module in {module for module, *_ in EQUIVALENT}
        for source in [(PACKAGE / module).read_text(encoding="utf-8")]
        for mutant in mutants(source)
    }
    assert EQUIVALENT.keys() - made == set()
