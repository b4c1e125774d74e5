"""Rules about who may import whom."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "pcc_addon"
SOURCES = sorted(PACKAGE.rglob("*.py"))
CORE = sorted((PACKAGE / "core").rglob("*.py"))
BLENDER_MODULES = {"bpy", "mathutils", "gpu", "bmesh", "bl_ui", "blf", "idprop", "aud", "gpu_extras", "bpy_extras"}

IMPORT_CORE_WITHOUT_BLENDER = """
import importlib, pkgutil, sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in BLOCKED:
            raise ImportError(name + " is blocked")
sys.meta_path.insert(0, Blocked())
import pcc_addon.core
names = [m.name for m in pkgutil.walk_packages(pcc_addon.core.__path__, "pcc_addon.core.")]
for name in names:
    importlib.import_module(name)
print(*names)
"""


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def _imports(path: Path) -> Iterator[tuple[int, str]]:
    """(level, dotted name) of everything that a file imports, in functions too; level 0 is absolute."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = f"{node.module}." if node.module else ""
            yield from ((node.level, base + alias.name) for alias in node.names)


def _reads_blender_version(tree: ast.AST) -> bool:
    """Whether code reads the version as a number; its text (`version_string`) may be shown anywhere."""
    return any(
        isinstance(node, ast.Attribute)
        and node.attr in ("version", "version_file", "version_cycle")
        and isinstance(node.value, ast.Attribute)
        and node.value.attr == "app"
        for node in ast.walk(tree)
    )


def test_the_rules_look_at_real_files() -> None:
    assert len(CORE) >= 14
    assert len(SOURCES) > len(CORE)


@pytest.mark.parametrize("path", CORE, ids=_name)
def test_core_imports_nothing_of_blender(path: Path) -> None:
    assert not [name for level, name in _imports(path) if level == 0 and name.partition(".")[0] in BLENDER_MODULES]


@pytest.mark.parametrize("path", CORE, ids=_name)
def test_core_imports_from_core_only(path: Path) -> None:
    depth = len(path.relative_to(PACKAGE / "core").parts)
    assert not [name for level, name in _imports(path) if level > depth]


@pytest.mark.parametrize("path", SOURCES, ids=_name)
def test_the_package_never_names_itself_absolutely(path: Path) -> None:
    """An installed extension's package is called bl_ext.<repository>.<id>.pcc_addon."""
    assert not [name for level, name in _imports(path) if level == 0 and name.partition(".")[0] == "pcc_addon"]


@pytest.mark.parametrize("path", SOURCES, ids=_name)
def test_only_compat_asks_which_blender_is_running(path: Path) -> None:
    reads = _reads_blender_version(ast.parse(path.read_text(encoding="utf-8")))
    assert reads == (_name(path) == "pcc_addon/blender/compat.py")


def test_paths_of_users_are_followed_by_what_refuses_no_link() -> None:
    """`workplace.real` says which; files of the add-on's own are no links to themselves."""
    lines = [line for path in SOURCES for line in path.read_text(encoding="utf-8").splitlines()]
    assert [line for line in lines if ".resolve()" in line and "Path(__file__).resolve()" not in line] == []


def test_every_core_module_imports_where_blender_is_missing() -> None:
    script = f"BLOCKED = {sorted(BLENDER_MODULES)!r}\n{IMPORT_CORE_WITHOUT_BLENDER}"
    run = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    files = {_name(path).removesuffix("/__init__.py").removesuffix(".py").replace("/", ".") for path in CORE}
    assert set(run.stdout.split()) == files - {"pcc_addon.core"}


ROAD = ["read", "store", "shade", "bake"]  # the rooms that data goes through; nobody imports from farther on


def _rooms(path: Path) -> Iterator[str]:
    """The rooms of `blender/` that a file imports from, itself in one."""
    here = path.relative_to(PACKAGE).parts[:-1]
    for level, name in _imports(path):
        target = (*here[: len(here) - level + 1], *name.split(".")) if level else ()
        if target[:1] == ("blender",) and len(target) > 1 and target[1] in ROAD:
            yield target[1]


@pytest.mark.parametrize("room", ROAD)
def test_data_goes_one_way(room: str) -> None:
    files = sorted((PACKAGE / "blender" / room).glob("*.py"))
    assert len(files) > 1
    farther = set(ROAD[ROAD.index(room) + 1 :])
    assert {_name(path): rooms for path in files if (rooms := farther & set(_rooms(path)))} == {}


def test_the_rule_sees_what_the_bake_imports() -> None:
    assert set(_rooms(PACKAGE / "blender" / "bake" / "job.py")) == set(ROAD)


RENDERERS = [
    p for folder in ("pcc_addon", "sample_blends", "benchmarks") for p in sorted((ROOT / folder).rglob("*.py"))
]


@pytest.mark.parametrize("path", RENDERERS, ids=_name)
def test_every_render_goes_through_one_door(path: Path) -> None:
    renders = "ops.render.render" in path.read_text(encoding="utf-8")
    assert renders == (_name(path) == "pcc_addon/blender/rendering.py")
