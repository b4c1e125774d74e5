"""The published vectors, through the node groups."""

from __future__ import annotations

import numpy as np
import pytest

from tests.vectors.ours import Check, checks

from .run import in_cycles


@pytest.mark.parametrize("check", checks(), ids=str)
def test_our_nodes_pass_the_vectors(scene, check: Check) -> None:
    met = check.met(in_cycles(check.formula.outputs, check.inputs))
    assert met.all(), np.flatnonzero(~met)
