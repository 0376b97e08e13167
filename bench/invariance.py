"""Charts of one mesh in other units, places and orders: how far the engine's count moves.

    python -m bench.invariance MESH.glb|FOLDER ... [--within 0.1]

Every mesh is unwrapped as it is and then scaled, moved by 1,000 of its extents, turned, and with
its vertices and faces in another order; a row tells the charts of each run and the largest change
against the plain one. The engine gets float64 positions: a GLB's float32 would lose the shape of a
mesh that far from the origin before anybody could unwrap it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.compare.meshes import MeshFile
from bench.unwrapping import mesh_parser, named_meshes, unwrapped

Array = NDArray[Any]
Variant = Callable[[Array, Array], tuple[Array, Array]]

_MOVED_EXTENTS = 1000.0


def scaled(factor: float) -> Variant:
    return lambda positions, faces: (positions * factor, faces)


def moved(positions: Array, faces: Array) -> tuple[Array, Array]:
    direction = np.array([0.6, -0.64, 0.48])
    return positions + _MOVED_EXTENTS * np.ptp(positions, axis=0).max() * direction, faces


def turned(seed: int) -> Variant:
    """A rotation from the QR decomposition of a random matrix, uniform over all rotations."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    rotation = q * np.sign(np.diag(r))
    rotation[:, 0] *= np.linalg.det(rotation)
    return lambda positions, faces: (positions @ rotation.T, faces)


def shuffled(seed: int) -> Variant:
    """Other numbers for vertices and faces, and another first corner for each face."""

    def shuffle(positions: Array, faces: Array) -> tuple[Array, Array]:
        random = np.random.default_rng(seed)
        order = random.permutation(len(positions))
        number = np.empty(len(order), np.int32)
        number[order] = np.arange(len(order), dtype=np.int32)
        first = random.integers(0, 3, (len(faces), 1))
        renamed = np.take_along_axis(number[faces], (first + np.arange(3)) % 3, axis=1)
        return positions[order], renamed[random.permutation(len(faces))]

    return shuffle


VARIANTS: dict[str, Variant] = {
    "x 1e-4": scaled(1e-4),
    "x 1e4": scaled(1e4),
    "moved": moved,
    "turned 1": turned(1),
    "turned 2": turned(2),
    "turned 3": turned(3),
    "shuffled 1": shuffled(1),
    "shuffled 2": shuffled(2),
}


def largest_change(counts: Sequence[int]) -> float:
    """Relative to the first count."""
    return max(abs(count - counts[0]) for count in counts) / counts[0]


def measured(meshes: Sequence[MeshFile]) -> Iterator[tuple[str, int, list[int]]]:
    """Name, faces, and the charts of the plain run and all variants."""
    for number, mesh in enumerate(meshes, start=1):
        positions, faces = mesh.arrays()
        counts = [len(unwrapped(positions, faces).charts["faces"])]
        for name, variant in VARIANTS.items():
            print(f"\r[{number}/{len(meshes)}] {mesh.name}: {name}\033[K", end="", file=sys.stderr)
            counts.append(len(unwrapped(*variant(positions, faces)).charts["faces"]))
        print("\r\033[K", end="", file=sys.stderr)
        yield mesh.name, len(faces), counts


def print_table(meshes: Sequence[MeshFile], within: float) -> None:
    """A row per mesh as soon as it is measured."""
    columns = ("mesh", "faces", "plain", *VARIANTS, "largest change")
    print("| " + " | ".join(columns) + " |")
    print("| --- |" + " ---: |" * (len(columns) - 1), flush=True)
    changes = []
    for name, faces, counts in measured(meshes):
        changes.append(largest_change(counts))
        cells = [f"{faces:,}", *(f"{count:,}" for count in counts), f"{100 * changes[-1]:.1f} %"]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    kept = sum(change <= within for change in changes)
    print(
        f"\n{kept} of {len(changes)} within {100 * within:g} %; "
        f"mean of the largest changes {100 * float(np.mean(changes)):.1f} %, "
        f"worst {100 * max(changes):.1f} %"
    )


def main() -> None:
    parser = mesh_parser("bench.invariance", __doc__)
    parser.add_argument("--within", type=float, default=0.1, help="change that counts as none")
    parsed = parser.parse_args()
    print_table(named_meshes(parsed.meshes), parsed.within)


if __name__ == "__main__":
    main()
