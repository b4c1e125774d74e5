"""`python -m pcc_addon SUB FILE.blend …`: the shell command with Blender as a module."""

from .cli import main

raise SystemExit(main())
