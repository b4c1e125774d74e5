"""A misfit as plain values, for programs."""

from __future__ import annotations

from .misfit import Fit, Misfit
from .unseen import Unseen


def record(found: Misfit, hidden: Unseen) -> dict[str, object]:
    """What is known of one probe: shares of all directions, metres, degrees, square metres."""
    shares = {fit: found.share(fit) for fit in Fit}
    return {
        "fit": {
            fit.value: {"share": share.share, "metres": share.metres, "degrees": share.degrees}
            for fit, share in shares.items()
        },
        "degrees": found.degrees,
        "area": hidden.area,
        "unseen_area": hidden.unseen_area,
        "idle_area": hidden.idle,
        "unseen": [
            {
                "object": part.name,
                "part": part.part.value,
                "materials": list(part.materials),
                "area": part.area,
                "share": part.share,
                "facing": list(part.facing),
            }
            for part in hidden.parts
        ],
    }
