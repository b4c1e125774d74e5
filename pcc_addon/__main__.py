"""`python -m pcc_addon SUB FILE.blend …`: the shell command with Blender as a module."""

from .stopping import hold


def run() -> int:
    """Nothing interrupts the start: `main` answers what came meanwhile."""
    hold()
    from .cli import main

    return main()


raise SystemExit(run())
