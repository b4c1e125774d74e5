"""What `pcc cost` measures, as plain records."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from ..probe import Engine


class Kind(str, Enum):
    """What made a picture that is compared with the truth."""

    PROBE = "PROBE"  # the probe, with some settings of its own
    PATH = "PATH"  # the render engine without probes
    SPHERE = "SPHERE"  # EEVEE with Blender's own sphere probe in the probe's place


@dataclass(frozen=True)
class Settings:
    """One rung: what an artist would set. What a kind does not have stays as it is here.

    Attributes:
        kind: what makes the picture.
        engine: that shows it.
        correction: as `pcc_probe.correction`: "NONE", "BOX" or "RELIEF"; of a sphere probe "BOX" where its parallax is
            that of the probe's box, else "NONE": that of a sphere, as Blender adds it.
        resolution: face width, pixels; of a probe or a sphere probe.
        bake_samples: per pixel of a face.
        bake_denoise: whether faces are denoised.
        half_float: whether the pictures are kept in half precision.
        steps, refinements: of relief.
        frame_samples: per pixel of the camera's picture.
        frame_denoise: whether it is denoised.
        ray_tracing: whether EEVEE traces its own rays.
        bake_adaptive: the noise at which a face's pixel is sampled no more; 0: all samples everywhere.
        fitted: whether box and capture point are those that a fit to the room gives, instead of those that are set.
        paired: whether the probe that shares the room is baked alike and shown too; else this one alone is shown.
    """

    kind: Kind
    engine: Engine
    correction: str = "BOX"
    resolution: int = 0
    bake_samples: int = 0
    bake_denoise: bool = False
    half_float: bool = False
    steps: int = 0
    refinements: int = 0
    frame_samples: int = 0
    frame_denoise: bool = False
    ray_tracing: bool = False
    bake_adaptive: float = 0.0
    fitted: bool = False
    paired: bool = False

    @property
    def bake_key(self) -> tuple:
        """What a bake depends on: rungs of the same key share one."""
        samples = (self.bake_samples, self.bake_denoise, self.bake_adaptive)
        relief = (self.correction == "RELIEF",) if self.kind is Kind.PROBE else ()
        return (self.kind, self.resolution, *samples, self.half_float, self.fitted, self.paired, *relief)


@dataclass(frozen=True)
class Measurement:
    """One rung, measured.

    Attributes:
        settings: of it.
        rmse: root mean square error over the root mean square of the truth, over the pixels that the probe serves.
        flip: mean HDR-FLIP there, 0 … 1.
        flicker: relative RMSE of the change from frame to frame against the truth's change; None: one frame only.
        bake_seconds: of all bakes it needs; 0 for path tracing.
        frame_seconds: of one frame.
        megabytes: of pictures, on disk.
        samplers: of the fullest material, as EEVEE counts them.
        picture: file name of its picture in the results' folder; empty: not kept.
    """

    settings: Settings
    rmse: float
    flip: float
    flicker: float | None
    bake_seconds: float
    frame_seconds: float
    megabytes: float = 0.0
    samplers: int = 0
    picture: str = ""


@dataclass(frozen=True)
class Truth:
    """The path-traced picture that all others are compared with.

    Attributes:
        samples: per pixel, of both halves together.
        noise: relative RMSE of its own noise over the served pixels, estimated from its two halves.
        seconds: it took.
        served: share of the picture's pixels that the probe serves.
        picture: file name in the results' folder.
    """

    samples: int
    noise: float
    seconds: float
    served: float
    picture: str = ""


@dataclass(frozen=True)
class CostReport:
    """All that one run of `pcc cost` found out.

    Attributes:
        file, scene, camera, probe: names.
        engine: whose frames are measured.
        width, height: of the camera's picture, pixels.
        frames: that were measured.
        truth: of the first frame.
        measurements: in the order in which they were made.
        where: processor, cores, Blender version, date.
        seconds: of the whole run, resumed ones included.
        budget: seconds that were allowed; None: the default.
        target: the error asked for; None: none was.
        planned: frames that the artist is going to render; None: unknown.
        heat_map: file name in the results' folder of a picture that shows where the recommended probe errs; empty:
            none.
        key: another where scene, probe, camera or what is asked is another; runs with the same one go on together.
        afresh: the recommended rung, measured once more with another seed and a bake of its own; None: not done.
    """

    file: str
    scene: str
    camera: str
    probe: str
    engine: Engine
    width: int
    height: int
    frames: tuple[int, ...]
    truth: Truth
    measurements: tuple[Measurement, ...] = field(default=())
    where: str = ""
    seconds: float = 0.0
    budget: float | None = None
    target: float | None = None
    planned: int | None = None
    heat_map: str = ""
    key: str = ""
    afresh: Measurement | None = None
