"""Where the error is: a furnished room's misfit and what its probe does not see, and a map of the picture's errors.

python3 dev.py run benchmarks/misfit.py
"""

from __future__ import annotations

import sys
from contextlib import redirect_stdout

import bpy
import numpy as np

from benchmarks.measure import ROOT, pixels_of, relative_rmse, render, start, table, write_page
from pcc_addon.blender.accuracy.misfit_job import MisfitJob, ProbeMisfit
from pcc_addon.core.accuracy.heat import heat_map
from pcc_addon.core.accuracy.misfit import Fit
from pcc_addon.core.accuracy.misfit_pictures import cross, unseen_around
from pcc_addon.core.accuracy.misfit_words import length, per_cent
from pcc_addon.core.accuracy.png import png_of_bytes
from sample_blends.two_rooms import LOUNGE, two_rooms

PROBE, FLOOR = "Lounge", "Tiles"
SIZE, FACE, SAMPLES, TRUTH = (192, 108), 128, 64, 192
LARGER = (1.0, 1.002, 1.01, 1.05)
_LEAST = 0.001  # of all directions
IMAGES = ROOT / "docs" / "images"


def survey(scene: bpy.types.Scene) -> ProbeMisfit:
    """What is found of the lounge's probe."""
    [found] = MisfitJob(scene, bpy.context.view_layer, [bpy.data.objects[PROBE]]).run()
    return found


def larger(by: float) -> None:
    """Draw the box larger."""
    bpy.data.objects[PROBE].scale = [by * half for half in LOUNGE.half_extents]
    bpy.context.view_layer.update()


def row(found: ProbeMisfit, by: float) -> list[str]:
    """Of the table: how a box lies to the room."""
    shares = [found.misfit.share(fit) for fit in (Fit.ON, Fit.BEFORE, Fit.BEYOND)]
    missed = [f"{per_cent(s.share)}, {length(s.metres)}" if s.share >= _LEAST else "—" for s in shares[1:]]
    return [
        f"{100.0 * (by - 1.0):g} %",
        per_cent(shares[0].share),
        *missed,
        f"{found.misfit.degrees:.1f}°",
        f"{found.seconds:.1f}",
    ]


def write(name: str, picture: np.ndarray) -> None:
    (IMAGES / name).write_bytes(png_of_bytes(picture))


def errors(scene: bpy.types.Scene) -> float:
    """The relative RMSE of the lounge's floor; writes the map of it."""
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    served = pixels_of(scene, {FLOOR})
    truth = render(scene, samples=TRUTH).pixels
    for probe in (bpy.data.objects[name].pcc_probe for name in ("Lounge", "Study")):
        probe.resolution, probe.samples = FACE, 32
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    picture = render(scene, samples=SAMPLES).pixels
    enlarged = [field.repeat(2, 0).repeat(2, 1) for field in (picture, truth, served)]
    write("misfit_heat.png", heat_map(*enlarged, end=0.5).picture)
    return relative_rmse(picture, truth, served)


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        scene = two_rooms(0.0)
        survey(scene)  # the first render takes longer
        rows, said = [], ()
        for by in LARGER:
            larger(by)
            found = survey(scene)
            rows.append(row(found, by))
            if by == LARGER[0]:
                said = found.lines
                write("misfit_faces.png", cross(found.misfit))
                write("misfit_unseen.png", unseen_around(found.misfit, found.unseen))
        write("misfit_larger.png", cross(found.misfit))
        larger(1.0)
        rmse = errors(scene)
    head = ["box drawn larger by", "on the box", "before it", "beyond it", "reflections off by", "seconds"]
    text = _TEXT.format(
        said="\n".join(f"- {line}" for line in said), table=table(head, rows), rmse=f"{rmse:.3f}", face=FACE
    )
    write_page("misfit.md", "Where the error is", "python3 dev.py run benchmarks/misfit.py", text)


_TEXT = """A probe shows things where they are as far as they lie on the walls of its box and as its capture point sees
them. *Fit* in the probe's Data tab, and `pcc misfit FILE`, say in seconds, without a bake, how far that is
so.

![The six faces of a furnished room, things before the box in red](images/misfit_faces.png)

*The lounge of the two rooms: the six directions along the world's axes, unfolded. Nearly white: the box lies on what
is seen. Red: a thing stands before it. Blue: what is seen lies beyond it. The thin lines are the box's edges.*

What is said of it:

{said}

## How to read it

- Distances are along the ray from the capture point, from the box's wall to what is seen. Within 1 cm counts as on
  the box. Shares are of all directions.
- *Off by*: a surface that mirrors a thing looks up the picture where its ray leaves the box, and not where the thing
  is. That is the angle between the two as seen from the capture point, on average over sixteen points of the surfaces
  that show the probe (or sixteen all over the box, while nothing shows it) and over the directions. Whether something
  stands between the two is not asked for. With *Relief* a lookup comes nearer than that.
- Unseen are surfaces in the probe's influence, by 20,000 points evenly over them. *Underside*, *top* and *back* face
  away from the capture point; of the rest a percentage is told, that something else hides. "Which 'Floor' may
  mirror": at least half of it faces that object, which shows the probe; what stands between is not asked for. What
  nothing faces, as the underside of a thing on the floor, is counted apart.
- Of closed meshes the outer sides count, of flat ones both, of other open ones those that their normals say. Hair and
  point clouds are left out, as are panes and what viewports hide. Things less than half a texel's width before a
  surface (2 cm at 2.5 m) hide nothing.
- No probe and no relief from one capture point brings back what is not seen: move the capture point, hide what is in
  its way, or add a second probe.

![Magenta dots where surfaces are not seen](images/misfit_unseen.png)

*The same room all around, as its picture is stored. Magenta: behind this are surfaces that the capture point does not
see.*

## A box that is too large

{table}

![The same room with a box that is 5 % too large](images/misfit_larger.png)

*The box drawn 5 % too large: walls are red too.*

## In the camera's picture

![The errors of the mirror floor](images/misfit_heat.png)

*Error of the floor, which mirrors as dielectrics do, over the root mean square of the truth there; the rest is grey.
Their root mean square is the relative RMSE, {rmse} here (faces of {face} px). Most of it is one patch: a lamp in the
mirror on the wall, mirrored again by the floor, while captures see metals matt. The rest is the furniture.*

## In the viewport

*Show in Viewport* colours the inner sides of the box as above, stronger the farther they miss, and marks unseen
surfaces with magenta squares on their unseen sides. When things have moved since, the panel says so."""


if __name__ == "__main__":
    main()
