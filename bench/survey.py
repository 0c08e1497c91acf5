# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far bakes of many different scenes are off, and whether their estimates say so: `python -m bench.survey`.

For each scene of `bench/varied_scenes.py`, and each quality: the error over the surface as `bench.accuracy` defines it,
the bake's own estimate of it, what the bake counted, and the faces that most of the error is on. A scene that misses
the error its quality promises, or whose estimate does not bound it, is marked. References are computed once, in a
minute or a few for each scene, and then read from disk.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .accuracy import Accuracy, FaceError, compare, irradiance_at_probes
from .measure import Judged
from .methods import ESTIMATE_OVER_TRUTH, LARGEST_ERROR
from .probes import area_uniform_probes
from .reference import Reference, combined, irradiance
from .scenes import SCENES
from .stopwatch import Cost, timed_once
from .varied_scenes import VARIED_SCENES

PROBES = 2000

# Noise of a reference, relative to the mean: as much as the smallest error that is asked for. Its square is taken off
# that of the error, which is then still known to a few hundredths of itself, as there are so many probes.
MOST_NOISE = min(LARGEST_ERROR.values())

# Paths for each point in one part of a reference, and how many parts there may be until it is below that noise.
SAMPLES = 1024
MOST_PARTS = 16


@dataclass(frozen=True)
class Finding:
    """What a bake of a quality came to."""

    quality: str
    accuracy: Accuracy
    estimate: float
    vertices: int
    patches: int
    rays: int
    cost: Cost

    @property
    def misses(self) -> str:
        """What was promised and not kept, in words; empty if all was."""
        rms, (low, high) = self.accuracy.rms, ESTIMATE_OVER_TRUTH
        found = ["error"] if rms > LARGEST_ERROR.get(self.quality, float("inf")) else []
        if not low * rms <= self.estimate <= high * rms:
            found.append("estimate")
        return ", ".join(found)


def quiet(name: str, probes: int = PROBES, most_noise: float = MOST_NOISE) -> Judged:
    """Return a scene with a reference of as many parts as its noise asks for, or the most."""
    scene = (SCENES | VARIED_SCENES)[name]()
    points = area_uniform_probes(scene, probes)
    where = points.position, points.normal, points.shading_normal
    parts: list[Reference] = []
    wanted = 1
    while True:
        parts += [irradiance(scene, *where, samples=SAMPLES, seed=k) for k in range(len(parts), wanted)]
        case = Judged(name, scene, points, combined(parts))
        noise = case.reference.noise
        if noise <= most_noise or wanted == MOST_PARTS:
            return case
        # Noise falls with the square root of the samples.
        wanted = min(max(wanted + 1, math.ceil(wanted * (noise / most_noise) ** 2)), MOST_PARTS)


def survey(case: Judged, quality: str) -> Finding:
    """Bake once, and compare."""
    settings = BakeSettings(quality=quality, keep_transport=False)
    result, cost = timed_once(lambda: bake(case.scene, settings))
    accuracy = compare(case.scene, case.probes, irradiance_at_probes(result, case.probes), case.reference)
    report = result.report
    counts = (report[key] for key in ("estimated_error", "vertices", "patches", "rays"))
    return Finding(quality, accuracy, *counts, cost)


def triangles_of(scene: Scene) -> int:
    """Return how many triangles a scene has."""
    return sum(len(mesh.triangles) for mesh in scene.meshes)


HEADER = (
    f"{'scene':<17}{'triangles':>9} {'quality':<8}{'error':>7}{'lit':>7}{'bias':>7}{'noise':>7}{'estimate':>9}"
    f"{'ratio':>6}{'vertices':>9}{'patches':>9}{'rays':>8}{'cpu':>7}  misses"
)


def line_of(case: Judged, found: Finding) -> str:
    """Return a bake as a line of the table: errors relative to the mean, rays in millions, processor seconds."""
    a = found.accuracy
    ratio = found.estimate / a.rms if a.rms > 0.0 else float("inf")
    return (
        f"{case.name:<17}{triangles_of(case.scene):>9,} {found.quality:<8}{a.rms:>7.2%}{a.lit_rms:>7.2%}{a.bias:>7.2%}"
        f"{a.reference_noise:>7.2%}{found.estimate:>9.2%}{ratio:>6.1f}{found.vertices:>9,}{found.patches:>9,}"
        f"{found.rays / 1e6:>7.1f}M{found.cost.processor_seconds:>7.1f}  {found.misses}"
    )


def line_of_face(face: FaceError) -> str:
    """Return a face as a line: its part of the squared error, and errors relative to its own mean."""
    return (
        f"    {face.name:<22}{face.share:>6.1%} of the squared error, {face.probes} probes, "
        f"mean {face.mean_reference:.4g}, bias {face.bias:.2%} +- {face.bias_sigma:.2%}, rms {face.rms:.2%}"
    )


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench.survey", description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="*", help="default: all of bench/varied_scenes.py")
    parser.add_argument("--quality", action="append", choices=QUALITIES, help="default: GOOD and HIGH")
    parser.add_argument("--faces", type=int, default=4, help="of the worst ones, how many are shown")
    parser.add_argument("--probes", type=int, default=PROBES)
    parser.add_argument("--noise", type=float, default=MOST_NOISE, help="of the references, relative to the mean")
    parser.add_argument("--references-only", action="store_true", help="compute what is missing; bake nothing")
    asked = parser.parse_args()
    for name in asked.scene:
        if name not in SCENES | VARIED_SCENES:
            parser.error(f"there is no scene {name}; there are {', '.join(SCENES | VARIED_SCENES)}")
    return asked


def main() -> None:
    """Bake, compare and print."""
    asked = arguments()
    print(HEADER, flush=True)
    for name in asked.scene or VARIED_SCENES:
        case = quiet(name, asked.probes, asked.noise)
        if asked.references_only:
            print(f"{name:<17} {case.reference.samples:,} samples, noise {case.reference.noise:.2%}", flush=True)
            continue
        for quality in asked.quality or LARGEST_ERROR:
            found = survey(case, quality)
            print(line_of(case, found), flush=True)
            for face in sorted(found.accuracy.faces, key=lambda face: -face.share)[: asked.faces]:
                print(line_of_face(face), flush=True)


if __name__ == "__main__":
    main()
