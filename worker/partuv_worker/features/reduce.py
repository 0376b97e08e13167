"""Fewer feature dimensions, the same distances: Ward's cost per merge is linear in them."""

import numpy as np
from numpy.typing import NDArray


def scale_to_unit(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """Scale rows to length 1, in place and without a copy of them; rows of length 0 stay."""
    lengths = np.sqrt(np.einsum("ij,ij->i", rows, rows))[:, None]
    np.divide(rows, lengths, out=rows, where=lengths > 0)
    return rows


def unit_rows(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """A copy of the rows, scaled to length 1; rows of length 0 stay."""
    return scale_to_unit(rows.copy())


def distance_basis(sample: NDArray[np.float32], lost: float, most: int) -> NDArray[np.float32]:
    """Orthonormal columns (C x d) in which unit rows keep all but `lost` of their variance.

    d is at most `most`, even if more is lost by that.

    The axes are those of the moments about the origin, not about the mean: so a row's length, too,
    can be read from its d coordinates, and rows may be projected before they are scaled.
    """
    rows = unit_rows(sample).astype(np.float64)
    moments = rows.T @ rows
    variance = np.trace(moments) - np.square(rows.sum(axis=0)).sum() / len(rows)
    values, vectors = np.linalg.eigh(moments)
    values, vectors = values[::-1], vectors[:, ::-1]
    left_out = np.trace(moments) - np.cumsum(values)
    dimensions = int(np.argmax(left_out <= lost * max(variance, 0.0) + 1e-12 * len(rows))) + 1
    return np.ascontiguousarray(vectors[:, : min(dimensions, most)].astype(np.float32))
