#!/usr/bin/env python3
"""Development tasks, from a clean clone and with the standard library alone.

python3 dev.py demo                 bake the gallery sample, render it four ways, make one labelled picture
python3 dev.py test [PYTEST ARG…]   run the tests (--blender 4.5|5.0|5.2, --all for every version, --heavy for the slow
                                    ones too; with --all another part each commit: PARTS)
python3 dev.py lint                 ruff: format and lint; mypy: types in core
python3 dev.py build                build and validate the extension's zip, its manual included, into build/
python3 dev.py release              the zip, its checksum and an index for Blender's updates into build/release/
python3 dev.py samples              rebuild sample_blends/*.blend
python3 dev.py run SCRIPT [ARG…]    run a script of this repository (benchmarks, docs) with Blender as a module

Each makes its own environment in .venvs/ the first time (one Blender wheel is about 400 MB).
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENVS = ROOT / ".venvs"
# Blender version: the Python that its bpy wheel is for. The last one whose Python is found is the default.
BLENDERS = {"4.5": "3.11", "5.0": "3.11", "5.2": "3.13"}
TOOLS = ["pytest==8.*", "hypothesis==6.*", "mpmath==1.*", "moderngl==5.*", "flip-evaluator==1.*", "openjd-cli==0.*"]
FIGURES = ["matplotlib==3.*", "pillow>=11"]
PAGES = ["markdown-it-py==4.*", "mdit-py-plugins==0.5.*"]  # of the manual that the zip has
# With --all, all Blenders but the newest run one of so many parts of the tests, each a part of its own. Each commit has
# other parts, and other cases of sweeps.
PARTS = 4
HALVES = 2  # the newest one's tests are run by so many processes, as each keeps one core busy
MEMORY_OF_A_SUITE = 4 << 30  # bytes; the heavy tests leave Blender with 3 GB
RUFF = "ruff==0.14.*"
TYPES = ["mypy==1.*", "numpy==2.*"]


def main() -> int:
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("task", choices=["demo", "test", "lint", "build", "release", "samples", "run"])
    parser.add_argument("--blender", choices=BLENDERS, help="which Blender version")
    parser.add_argument("--all", action="store_true", help="every supported Blender version")
    parser.add_argument("--heavy", action="store_true", help="tests: the slow ones too")
    parser.add_argument("--at-once", type=int, help="tests: how many suites at once (else what cores and memory allow)")
    options, rest = parser.parse_known_args()
    tasks = {
        "demo": demo,
        "test": test,
        "lint": lint,
        "build": build,
        "release": release,
        "samples": samples,
        "run": run,
    }
    return tasks[options.task](options, rest)


def demo(options: argparse.Namespace, rest: list[str]) -> int:
    return call(blender_python(options.blender), "-m", "sample_blends.demo", *rest)


def test(options: argparse.Namespace, rest: list[str]) -> int:
    """What pytest is asked for as it is; else several suites side by side, each line with whose it is before it."""
    arguments = ["-m", "pytest", *(["--heavy"] if options.heavy else []), *rest]
    if rest and not options.all:
        python = blender_python(options.blender)
        print(f"== tests with Blender {python.parent.parent.name.removeprefix('bpy-')}", flush=True)
        return call(python, *arguments)
    versions = available() if options.all else [options.blender or available()[-1]]
    pythons = {version: blender_python(version) for version in versions}
    names = suites(versions)
    at_once = options.at_once or max(1, min(len(names), os.cpu_count() or 1, free_memory() // MEMORY_OF_A_SUITE))
    print(f"== tests with Blender {', '.join(names)}: {at_once} at once", flush=True)

    def run_suite(name: str) -> int:
        return call_aloud(f"{name} | ", pythons[name.split()[0]], *arguments, *names[name])

    with ThreadPoolExecutor(at_once) as pool:
        codes = list(pool.map(run_suite, names))
    for name, code in zip(names, codes, strict=True):
        print(f"== Blender {name}: {'passed' if code == 0 else f'FAILED with exit code {code}'}", flush=True)
    return first_failure(codes)


def suites(versions: list[str]) -> dict[str, list[str]]:
    """Options of pytest by Blender and part, "5.2 1/2": all parts for the last Blender, one for each other."""
    *others, newest = versions
    sweeps = ["--sweeps", str(commits())] if others else []
    found = {f"{newest} {k}/{HALVES}": ["--part", f"{k}/{HALVES}", *sweeps] for k in range(HALVES)}
    complete = {BLENDERS[version]: version for version in reversed(versions)}.values()  # the first of each Python
    for k, version in enumerate(others):
        part = f"{(commits() + k) % PARTS}/{PARTS}"
        found[f"{version} {part}"] = [
            *("--part", part),
            *sweeps,
            *([] if version in complete else ["--only-with-blender"]),
        ]
    return found


def lint(options: argparse.Namespace, rest: list[str]) -> int:
    python = environment("lint", Path(sys.executable), [RUFF, *TYPES])
    return first_failure(
        [
            call(python, "-m", "ruff", "format", *(rest or ["--check", "."])),
            call(python, "-m", "ruff", "check", "."),
            call(python, "-m", "mypy"),
        ]
    )


def build(options: argparse.Namespace, rest: list[str]) -> int:
    python = blender_python(options.blender)
    return call(python, "-m", "tests.packaging.extension", str(ROOT / "build"))


def release(options: argparse.Namespace, rest: list[str]) -> int:
    return call(blender_python(options.blender), "-m", "tests.packaging.release", str(ROOT / "build" / "release"))


def samples(options: argparse.Namespace, rest: list[str]) -> int:
    return call(blender_python(options.blender or "4.5"), "-m", "sample_blends.build")


def run(options: argparse.Namespace, rest: list[str]) -> int:
    if not rest:
        sys.exit("dev.py run: name a script")
    return call(blender_python(options.blender), *rest)


def blender_python(version: str | None) -> Path:
    """The interpreter of the environment with that Blender version, or with the newest that can be had."""
    version = version or available()[-1]
    interpreter = find_interpreter(BLENDERS[version])
    if interpreter is None:
        sys.exit(f"Blender {version} as a module needs Python {BLENDERS[version]}, and there is none; {HOW_TO_GET}")
    return environment(f"bpy-{version}", interpreter, [f"bpy=={version}.*", *TOOLS, *FIGURES, *PAGES])


HOW_TO_GET = "install one (for example with pyenv, uv or your system's packages) and try again"


def available() -> list[str]:
    """The Blender versions whose Python is on this machine."""
    found = [version for version, python in BLENDERS.items() if find_interpreter(python)]
    missing = sorted(set(BLENDERS.values()) - {BLENDERS[v] for v in found})
    if not found:
        sys.exit(f"no Python that a bpy wheel exists for ({', '.join(missing)}) was found; {HOW_TO_GET}")
    if missing:
        skipped = ", ".join(v for v in BLENDERS if v not in found)
        print(f"No Python {', '.join(missing)} found: leaving out Blender {skipped}", file=sys.stderr)
    return found


def find_interpreter(wanted: str) -> Path | None:
    """An interpreter of Python `wanted`, wherever the usual tools keep one."""
    candidates = [sys.executable, shutil.which(f"python{wanted}")]
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates += [str(p) for p in sorted(pyenv.glob(f"{wanted}.*/bin/python"), reverse=True)]
    if shutil.which("uv"):
        found = subprocess.run(["uv", "python", "find", wanted], capture_output=True, text=True)
        candidates.append(found.stdout.strip())
    if os.name == "nt" and shutil.which("py"):
        found = subprocess.run(
            ["py", f"-{wanted}", "-c", "import sys; print(sys.executable)"], capture_output=True, text=True
        )
        candidates.append(found.stdout.strip())
    return next((Path(c) for c in candidates if c and is_python(c, wanted)), None)


def is_python(candidate: str, wanted: str) -> bool:
    """Whether a program is that Python and can make environments; some are shims that refuse."""
    probe = "import sys, ensurepip, venv; print('%d.%d' % sys.version_info[:2])"
    try:
        answer = subprocess.run([candidate, "-c", probe], capture_output=True, text=True, timeout=60)
    except OSError:
        return False
    return answer.returncode == 0 and answer.stdout.strip() == wanted


def environment(name: str, interpreter: Path, requirements: list[str]) -> Path:
    """The interpreter of a virtual environment with `requirements`, made or mended where needed."""
    place = VENVS / name
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp = place / "requirements.stamp"
    wanted = hashlib.sha256("\n".join(requirements).encode()).hexdigest()
    if python.exists() and stamp.exists() and stamp.read_text() == wanted:
        return python
    print(f"Making the environment {place.relative_to(ROOT)} …", flush=True)
    subprocess.run([interpreter, "-m", "venv", "--clear", place], check=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *requirements]
    if subprocess.run(pip).returncode:
        shutil.rmtree(place)
        sys.exit(f"pip could not install {', '.join(requirements)}; see its message above")
    stamp.write_text(wanted)
    return python


def call(python: Path, *arguments: str) -> int:
    return subprocess.run([str(python), *arguments], cwd=ROOT, env=surroundings()).returncode


def call_aloud(mark: str, python: Path, *arguments: str) -> int:
    """The same, with `mark` before each line of output, so that several may talk at once."""
    command = [str(python), *arguments]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "encoding": "utf-8", "errors": "replace"}
    with subprocess.Popen(command, cwd=ROOT, env=surroundings(), **streams) as process:
        for line in process.stdout:
            print(f"{mark}{line}", end="", flush=True)
    return process.returncode


def surroundings() -> dict[str, str]:
    """The environment of programs that import this repository's packages."""
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def first_failure(codes: list[int]) -> int:
    """0 where all are; a program that a signal ended has a negative code, which is a failure too."""
    return next((code for code in codes if code), 0)


def commits() -> int:
    """How many there are; 0 where this is no clone."""
    try:
        found = subprocess.run(["git", "rev-list", "--count", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    except OSError:
        return 0
    return int(found.stdout) if found.returncode == 0 else 0


def free_memory() -> int:
    """Bytes that programs may still take, as far as Linux tells; 0 elsewhere."""
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
        free = next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
        limit = Path("/sys/fs/cgroup/memory.max")  # of a container
        used = Path("/sys/fs/cgroup/memory.current")
        if limit.exists() and limit.read_text().strip() != "max":
            free = min(free, int(limit.read_text()) - int(used.read_text()))
    except (OSError, StopIteration):
        return 0
    return free


if __name__ == "__main__":
    raise SystemExit(main())
