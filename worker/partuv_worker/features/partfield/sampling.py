"""Where the network looks: the frame of its input, the surface cloud and the points on a face.

Everything works on copies; the mesh keeps its place and scale.
"""

import numpy as np
from numpy.typing import NDArray

from partuv_worker.partfield_settings import Frame

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]


def normalised_positions(positions: FloatArray, frame: Frame) -> FloatArray:
    """Positions (V x 3) in the network's frame, every vertex counting for the bounds.

    "partfield" fills [-0.9, 0.9], the frame the weights were trained in. "partuv" fills
    [0.05, 0.95], as the published PartUV pipeline does: half the size, in one octant.
    """
    low, high = positions.min(axis=0), positions.max(axis=0)
    extent = float((high - low).max())
    scale = 1 / extent if extent > 0 else 0.0
    centred = (positions - (low + high) / 2) * scale
    placed: FloatArray = centred * 1.8 if frame == "partfield" else centred * 0.9 + 0.5
    return placed


def face_areas(positions: FloatArray, faces: IndexArray) -> FloatArray:
    """Area of each face."""
    first, second, third = (positions[faces[:, i]] for i in range(3))
    areas: FloatArray = np.linalg.norm(np.cross(second - first, third - first), axis=1) / 2
    return areas


def surface_cloud(
    positions: FloatArray, faces: IndexArray, count: int, seed: int
) -> tuple[NDArray[np.float32], IndexArray]:
    """Points (count x 3) spread evenly by area, and the face of each.

    A surface without area is sampled evenly by face.
    """
    random = np.random.default_rng(seed)
    cumulated = np.cumsum(face_areas(positions, faces))
    if not cumulated[-1] > 0:
        cumulated = np.arange(1, len(faces) + 1, dtype=np.float64)
    face = np.searchsorted(cumulated, random.random(count) * cumulated[-1]).astype(np.int32)
    across = random.random((count, 2))
    outside = across.sum(axis=1) > 1
    across[outside] = np.abs(across[outside] - 1)
    corners = positions[faces[face]]
    points = corners[:, 0] + np.einsum("nk,nkd->nd", across, corners[:, 1:] - corners[:, :1])
    return points.astype(np.float32), face


def face_points(corners: NDArray[np.float32], draws: NDArray[np.float32]) -> NDArray[np.float32]:
    """Evenly distributed points on faces: corners N x 3 x 3, draws N x K x 2 in [0, 1).

    The square root makes the density uniform (Osada et al. 2002, section 3.1).
    """
    root = np.sqrt(draws[..., 0])
    weights = np.stack([1 - root, root * (1 - draws[..., 1]), root * draws[..., 1]], axis=-1)
    points: NDArray[np.float32] = np.matmul(weights, corners)
    return points
