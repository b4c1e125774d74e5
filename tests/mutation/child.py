"""Runs tests under one change of one module, made in memory only: python -m tests.mutation.child MODULE NUMBER …

MODULE is a file below pcc_addon, NUMBER one of its mutants or "none"; what follows goes to pytest.
"""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import importlib.util
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import CodeType, ModuleType

import pytest

from .mutants import mutated

PACKAGE = Path(__file__).resolve().parents[2] / "pcc_addon"


class _Loader(importlib.machinery.SourceFileLoader):
    number = 0

    def get_code(self, fullname: str) -> CodeType:
        return compile(mutated(Path(self.path).read_text(encoding="utf-8"), self.number), self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the changed module, and no other."""

    def __init__(self, module: str, number: int) -> None:
        self.path = PACKAGE / module
        parts = ("pcc_addon", *Path(module).with_suffix("").parts)
        self.name = ".".join(part for part in parts if part != "__init__")
        self.loader = _Loader(self.name, str(self.path))
        self.loader.number = number

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(fullname, self.path, loader=self.loader)


def main() -> None:
    module, number, *arguments = sys.argv[1:]
    if number != "none":
        sys.meta_path.insert(0, _Finder(module, int(number)))
    code = pytest.main(["-x", "-q", "--no-header", "--tb=line", *arguments])
    sys.stdout.flush()
    os._exit(int(code))  # Blender need not tidy up


if __name__ == "__main__":
    main()
