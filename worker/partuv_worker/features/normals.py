"""Face normals as part features: the ablation of the PartUV paper, kept for comparison."""

import time

import numpy as np
from numpy.typing import NDArray

from partuv_worker.features.prior import FaceFeatures, PriorResult, Progress


def unit_normals(positions: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float32]:
    """F x 3 unit normals; 0 for faces without area."""
    first, second, third = (positions[faces[:, i]] for i in range(3))
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    units = np.zeros_like(normals)
    np.divide(normals, lengths, out=units, where=lengths > 0)
    return units.astype(np.float32)


class NormalsPrior:
    name = "normals"
    version = "1"

    def parts(
        self,
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        *,
        threads: int = 1,
        progress: Progress = lambda done: None,
    ) -> PriorResult:
        """One normal per face."""
        start = time.perf_counter()
        values = unit_normals(positions, faces)
        progress(1.0)
        return PriorResult(
            self.name, self.version, time.perf_counter() - start, FaceFeatures(values)
        )
