"""The PartField prior: network, face means and reduction in one go, in bounded memory."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import torch
from numpy.typing import NDArray
from partuv_contract.errors import FeaturesError
from torch import Tensor

from partuv_worker.features.partfield.checkpoint import read_checkpoint
from partuv_worker.features.partfield.lookup import point_means
from partuv_worker.features.partfield.network import PartFieldNetwork
from partuv_worker.features.partfield.point_voxel import PLANE_AXES
from partuv_worker.features.partfield.sampling import (
    face_points,
    normalised_positions,
    surface_cloud,
)
from partuv_worker.features.prior import FaceFeatures, PriorResult, Progress
from partuv_worker.features.reduce import distance_basis, scale_to_unit
from partuv_worker.partfield_settings import PartFieldSettings

# Sample points looked up at once: about 0.3 GB of table indices and weights at the most.
POINTS_PER_CHUNK = 1 << 18
# Faces that decide on the reduced dimensions.
BASIS_FACES = 16384
# The result is held to this size, whatever that costs in variance: 448 dimensions fit for 300,000
# faces, 134 for a million.
RESULT_BYTES = 1 << 29
NETWORK_SHARE = 0.8  # of the progress


class PartFieldPrior:
    """Loads and verifies the weights at once; every job afterwards reuses them."""

    name = "partfield"

    def __init__(self, settings: PartFieldSettings) -> None:
        if settings.device == "cuda" and not torch.cuda.is_available():
            raise FeaturesError("the part features are set to run on cuda, but torch finds no GPU")
        checkpoint = read_checkpoint(settings.checkpoint)
        self.settings = settings
        self.version = f"sha256:{checkpoint.weights_sha256}"
        self._network = checkpoint.network().to(settings.device)

    def parts(
        self,
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        *,
        threads: int = 1,
        progress: Progress = lambda done: None,
    ) -> PriorResult:
        """Unit features of few dimensions, with the distances of all 448."""
        start = time.perf_counter()
        torch.set_num_threads(threads)
        with torch.inference_mode():
            values = reduced_features(self._network, positions, faces, self.settings, progress)
        return PriorResult(
            self.name, self.version, time.perf_counter() - start, FaceFeatures(values)
        )


def reduced_features(
    network: PartFieldNetwork,
    positions: NDArray[np.float64],
    faces: NDArray[np.int32],
    settings: PartFieldSettings,
    progress: Progress = lambda done: None,
) -> NDArray[np.float32]:
    """F x d rows of length 1 that keep all but `variance_lost` of the unit features' variance.

    The network's planes are reduced instead of its features (the look-up is linear), so memory
    is a result of at most `RESULT_BYTES` and a chunk, whatever the number of faces.
    """
    placed = normalised_positions(positions, settings.frame)
    table = part_table(network, placed, faces, settings, progress)
    sample = faces[:: -(-len(faces) // BASIS_FACES)]
    rows = face_features(table, placed, sample, settings)
    basis = distance_basis(rows, settings.variance_lost, max(1, RESULT_BYTES // (4 * len(faces))))
    reduced = table @ torch.from_numpy(basis).to(table.device)

    def rest(done: float) -> None:
        progress(NETWORK_SHARE + (1 - NETWORK_SHARE) * done)

    return scale_to_unit(face_features(reduced, placed, faces, settings, rest))


def part_table(
    network: PartFieldNetwork,
    placed: NDArray[np.float64],
    faces: NDArray[np.int32],
    settings: PartFieldSettings,
    progress: Progress = lambda done: None,
) -> Tensor:
    """The part planes of a mesh in the network's frame, one row per texel."""
    cloud, _ = surface_cloud(placed, faces, settings.points, settings.seed)
    points = torch.from_numpy(cloud).to(settings.device)
    half = torch.float16 if settings.device == "cuda" else torch.bfloat16
    with (
        torch.autocast(settings.device, half, enabled=settings.precision == "half"),
        _progress_of(network, progress),
    ):
        planes: Tensor = network(points)
    return planes.float().reshape(-1, planes.shape[-1])


def face_features(
    table: Tensor,
    placed: NDArray[np.float64],
    faces: NDArray[np.int32],
    settings: PartFieldSettings,
    progress: Progress = lambda done: None,
) -> NDArray[np.float32]:
    """Mean of the table's features over random points of each face, F x C.

    Each face has its own stretch of the random stream: the result does not depend on the chunks.
    """
    count = settings.points_per_face
    plane = round((len(table) / 3) ** 0.5)
    random = np.random.default_rng(settings.seed)
    single = placed.astype(np.float32)
    values = np.empty((len(faces), table.shape[1]), np.float32)
    step = max(1, POINTS_PER_CHUNK // count)
    for begin in range(0, len(faces), step):
        chunk = faces[begin : begin + step]
        draws = random.random((len(chunk), count, 2), dtype=np.float32)
        points = torch.from_numpy(face_points(single[chunk], draws)).to(table.device)
        values[begin : begin + step] = point_means(table, points, plane).cpu().numpy()
        progress(min(1.0, (begin + step) / len(faces)))
    return values


@contextmanager
def _progress_of(network: PartFieldNetwork, progress: Progress) -> Iterator[None]:
    """Report after each stage of the network that takes long; stages count alike."""
    head = network.triplane_transformer
    stages = [network.pvcnn.pc_encoder.encoder[0], network.pvcnn.unet_encoder]
    stages += [head.downsampler, *head.transformer.layers]
    calls = len(stages) + len(PLANE_AXES) - 1  # the planes pass the down-sampler one by one
    done = 0

    def report(*_: object) -> None:
        nonlocal done
        done += 1
        progress(NETWORK_SHARE * done / calls)

    handles = [stage.register_forward_hook(report) for stage in stages]
    try:
        yield
    finally:
        for handle in handles:
            handle.remove()
