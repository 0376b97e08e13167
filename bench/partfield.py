"""What the PartField prior costs, and what its settings change.

`python -m bench.partfield cost|settings|tree [--checkpoint FILE] [--mesh FILE.glb] [--threads N]`
from the root of the repository. Without a checkpoint the tests' deterministic weights are used:
they cost the same, but their features mean nothing, so figures about trees are only a hint then.
Processor seconds are the ones to compare on a machine that does other things as well.
"""

from __future__ import annotations

import argparse
import os
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as functional
from numpy.typing import NDArray
from partuv_engine import _core
from partuv_worker import samples
from partuv_worker.features.partfield import lookup, prior, products, transformer
from partuv_worker.features.partfield.checkpoint import read_checkpoint
from partuv_worker.features.partfield.network import PartFieldNetwork, expected_parameters
from partuv_worker.features.partfield.point_voxel import point_features
from partuv_worker.features.partfield.sampling import normalised_positions, surface_cloud
from partuv_worker.features.reduce import distance_basis, unit_rows
from partuv_worker.glb.limits import DEFAULT_LIMITS
from partuv_worker.glb.scene import Scene
from partuv_worker.partfield_settings import PartFieldSettings
from sklearn.metrics import adjusted_rand_score

from tests.support.partfield import filled_state

ROBOT = Path(samples.__file__).parent / "robot.glb"
DEFAULTS = PartFieldSettings(Path("unused"))
TOP_CLUSTERS = 20


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("cost", "settings", "tree"))
    parser.add_argument("--checkpoint", type=Path)
    parser.add_argument("--mesh", type=Path, default=ROBOT)
    parser.add_argument("--threads", type=int, default=1)
    parsed = parser.parse_args()
    torch.set_num_threads(parsed.threads)
    soup = Scene(parsed.mesh.read_bytes(), DEFAULT_LIMITS).soup
    network = load(parsed.checkpoint)
    load_1, _, _ = os.getloadavg()
    print(
        f"{parsed.mesh.name}: {len(soup.faces)} faces; {parsed.threads} threads; load {load_1:.1f}"
    )
    with torch.inference_mode():
        {"cost": cost, "settings": settings, "tree": tree}[parsed.what](
            network, soup.positions, soup.faces
        )


def load(checkpoint: Path | None) -> PartFieldNetwork:
    if checkpoint is not None:
        return read_checkpoint(checkpoint).network()
    with torch.device("meta"):
        network = PartFieldNetwork()
    network.load_state_dict(filled_state(expected_parameters()), assign=True)
    return network.requires_grad_(False).eval()


def cost(network: PartFieldNetwork, positions: NDArray[Any], faces: NDArray[Any]) -> None:
    """Seconds of every step, peak memory, and what each measure of ours saves."""
    placed = normalised_positions(positions, DEFAULTS.frame)
    table = network_cost(network, placed, faces)
    feature_cost(table, placed, faces)
    print("\nwithout our measures:")
    plain_cost(network, table, placed, faces)


def network_cost(
    network: PartFieldNetwork, placed: NDArray[Any], faces: NDArray[Any]
) -> torch.Tensor:
    timed("surface points", lambda: surface_cloud(placed, faces, DEFAULTS.points, DEFAULTS.seed))
    cloud, _ = surface_cloud(placed, faces, DEFAULTS.points, DEFAULTS.seed)
    points = torch.from_numpy(cloud)
    network(points[:2000])  # the first call prepares kernels
    print(f"memory with the weights: {peak_gb():.2f} GB")
    encoder, head = network.pvcnn, network.triplane_transformer
    planes = timed("network: points to planes, U-Net", lambda: encoder(points))
    tokens = timed("network: down-sampler", lambda: head.tokens(planes))
    timed("network: transformer", lambda: head.transformer(tokens))
    table: torch.Tensor = timed("network: all", lambda: network(points))
    print(f"peak memory: {peak_gb():.2f} GB")
    return table.reshape(-1, table.shape[-1])


def feature_cost(table: torch.Tensor, placed: NDArray[Any], faces: NDArray[Any]) -> None:
    sample = faces[:: -(-len(faces) // prior.BASIS_FACES)]
    rows = timed(
        f"features of {len(sample)} faces, 448 channels",
        lambda: prior.face_features(table, placed, sample, DEFAULTS),
    )
    basis = timed("basis", lambda: distance_basis(rows, DEFAULTS.variance_lost, rows.shape[1]))
    reduced = table @ torch.from_numpy(basis)
    timed(
        f"features of {len(faces)} faces, {basis.shape[1]} channels",
        lambda: prior.face_features(reduced, placed, faces, DEFAULTS),
    )
    million = np.tile(faces, (-(-1_000_000 // len(faces)), 1))[:1_000_000]
    most = prior.RESULT_BYTES // (4 * len(million))
    fewer = table @ torch.from_numpy(np.ascontiguousarray(basis[:, :most]))
    timed(
        f"features of {len(million)} faces, {fewer.shape[1]} channels",
        lambda: prior.face_features(fewer, placed, million, DEFAULTS),
    )
    print(f"peak memory: {peak_gb():.2f} GB")


def plain_cost(
    network: PartFieldNetwork, table: torch.Tensor, placed: NDArray[Any], faces: NDArray[Any]
) -> None:
    cloud, _ = surface_cloud(placed, faces, DEFAULTS.points, DEFAULTS.seed)
    points = torch.from_numpy(cloud)
    with plain_linear():
        timed("network, torch's own matrix products", lambda: network(points))
    timed("unused point-voxel blocks", lambda: unused_blocks(network, points))
    half = replace(DEFAULTS, precision="half")
    rounded = timed(
        "network in half precision", lambda: prior.part_table(network, placed, faces, half)
    )
    print(f"    its planes differ by {relative_rms(rounded, table):.1e}")
    few = faces[:: -(-len(faces) // 4096)]
    with windows(()):
        timed(
            f"{len(few)} faces, four rows a sample and plane",
            lambda: prior.face_features(table, placed, few, DEFAULTS),
        )
    timed(
        f"{len(few)} faces, shared windows",
        lambda: prior.face_features(table, placed, few, DEFAULTS),
    )
    with grid_sampling(table.reshape(3, network.shape.plane, network.shape.plane, -1)):
        timed(
            f"{len(few)} faces, grid_sample",
            lambda: prior.face_features(table, placed, few, DEFAULTS),
        )


def settings(network: PartFieldNetwork, positions: NDArray[Any], faces: NDArray[Any]) -> None:
    """How far features and top clusters move when a setting changes."""
    surface = _core.Surface(positions, faces)

    def run(changed: PartFieldSettings) -> tuple[NDArray[Any], float]:
        placed = normalised_positions(positions, changed.frame)
        start = time.process_time()
        table = prior.part_table(network, placed, faces, changed)
        rows = unit_rows(prior.face_features(table, placed, faces, changed))
        return rows, time.process_time() - start

    exact, _ = run(replace(DEFAULTS, points_per_face=200))
    labels = top_clusters(surface, exact)
    spread = np.sqrt(np.square(exact - exact.mean(axis=0)).sum(axis=1).mean())
    print(f"reference: 200 points per face; features vary by {spread:.3f} about their mean")
    print("| setting | CPU s | moved, of their variation | same pairs in the top 20 (ARI) |")
    print("| --- | --- | --- | --- |")
    variants: dict[str, PartFieldSettings] = {"defaults": DEFAULTS}
    variants["another seed"] = replace(DEFAULTS, seed=43)
    for count in (1_000, 5_000, 10_000, 20_000, 50_000, 200_000):
        variants[f"points {count}"] = replace(DEFAULTS, points=count)
    for count in (1, 3, 50):
        variants[f"points_per_face {count}"] = replace(DEFAULTS, points_per_face=count)
    variants["precision half"] = replace(DEFAULTS, precision="half")
    for name, changed in variants.items():
        rows, seconds = run(changed)
        moved = np.sqrt(np.square(rows - exact).sum(axis=1).mean()) / spread
        agreement = adjusted_rand_score(labels, top_clusters(surface, rows))
        print(f"| {name} | {seconds:.1f} | {moved:.1%} | {agreement:.3f} |", flush=True)


def tree(network: PartFieldNetwork, positions: NDArray[Any], faces: NDArray[Any]) -> None:
    """What fewer dimensions do to distances, the tree and the clustering's time."""
    surface = _core.Surface(positions, faces)
    placed = normalised_positions(positions, DEFAULTS.frame)
    table = prior.part_table(network, placed, faces, DEFAULTS)
    full = prior.face_features(table, placed, faces, DEFAULTS)
    units = unit_rows(full)
    start = time.process_time()
    labels = top_clusters(surface, units)
    seconds = time.process_time() - start
    print("| variance given up | dimensions | Ward, CPU s | same pairs in the top 20 (ARI) |")
    print("| --- | --- | --- | --- |")
    print(f"| none | {units.shape[1]} | {seconds:.2f} | 1 |")
    for lost in (1e-1, 3e-2, 1e-2, 1e-3, 1e-4):
        basis = distance_basis(full, lost, full.shape[1])
        rows = unit_rows(full @ basis)
        start = time.process_time()
        agreement = adjusted_rand_score(labels, top_clusters(surface, rows))
        seconds = time.process_time() - start
        print(f"| {lost:.1%} | {basis.shape[1]} | {seconds:.2f} | {agreement:.3f} |")


def top_clusters(surface: Any, rows: NDArray[Any]) -> NDArray[np.int64]:
    """Label of each face of the surface when the last merges of its Ward tree are undone."""
    part_tree = _core.build_ward_tree(surface, np.ascontiguousarray(rows[surface.source_face]))
    faces = part_tree.face_count
    first_undone = 2 * faces - 1 - (TOP_CLUSTERS - 1)
    labels = np.zeros(faces, np.int64)
    children = np.concatenate([part_tree.left, part_tree.right])[
        np.tile(np.arange(faces - 1) + faces >= first_undone, 2)
    ]
    for number, node in enumerate(child for child in children if child < first_undone):
        labels[part_tree.order[part_tree.begin[node] : part_tree.end[node]]] = number
    return labels


def unused_blocks(network: PartFieldNetwork, points: torch.Tensor) -> None:
    first, *others = network.pvcnn.pc_encoder.encoder
    features = first.point_features(point_features(points))
    for block in others:
        features = block(features, points)


@contextmanager
def plain_linear() -> Iterator[None]:
    ours = products.linear
    products.linear = transformer.linear = functional.linear
    try:
        yield
    finally:
        products.linear = transformer.linear = ours


@contextmanager
def windows(sizes: tuple[int, ...]) -> Iterator[None]:
    ours, lookup.WINDOW_TEXELS = lookup.WINDOW_TEXELS, sizes
    try:
        yield
    finally:
        lookup.WINDOW_TEXELS = ours


@contextmanager
def grid_sampling(planes: torch.Tensor) -> Iterator[None]:
    images = planes.permute(0, 3, 1, 2).contiguous()

    def means(table: torch.Tensor, points: torch.Tensor, plane: int) -> torch.Tensor:
        places = torch.stack([points[..., [0, 1]], points[..., [1, 2]], points[..., [0, 2]]])
        read = functional.grid_sample(images, places, padding_mode="border", align_corners=True)
        return read.sum(dim=0).mean(dim=2).T

    ours, prior.point_means = prior.point_means, means
    try:
        yield
    finally:
        prior.point_means = ours


def timed(name: str, work: Callable[[], Any]) -> Any:
    wall, processor = time.perf_counter(), time.process_time()
    result = work()
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    print(f"{name:58} {processor:7.2f} CPU s {wall:7.2f} s", flush=True)
    return result


def relative_rms(values: torch.Tensor, expected: torch.Tensor) -> float:
    return float((values - expected).square().mean().sqrt() / expected.square().mean().sqrt())


def peak_gb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


if __name__ == "__main__":
    main()
