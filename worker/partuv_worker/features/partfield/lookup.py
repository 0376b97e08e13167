"""Part features of points and faces: bilinear readings of three planes, added up.

Planes are a table of rows, 3 * R * R x C. The mean over the sample points of a face is linear in
the planes, so it is one weighted sum of table rows; and as a bilinear weight is a product of two
hat functions, samples that fall into a window of S x S texels share S * S rows per plane instead
of four rows each.
"""

import torch
from torch import Tensor

from partuv_worker.features.partfield.bags import weighted_rows
from partuv_worker.features.partfield.point_voxel import PLANE_AXES

# Windows worth a pass of their own: beyond these, four rows per sample are the cheaper sum.
WINDOW_TEXELS = (2, 3, 4, 6)


def texel_position(points: Tensor, plane: int) -> Tensor:
    """Fractional texel index of points in [-1, 1]; the outer texels' centres lie on -1 and 1."""
    return ((points + 1) / 2 * (plane - 1)).clamp(0, plane - 1)


def point_means(table: Tensor, points: Tensor, plane: int) -> Tensor:
    """Mean feature over the K points of each row: points N x K x 3, result N x C."""
    position = texel_position(points, plane)
    first = position.floor().clamp(max=plane - 2)
    low, high = first.amin(dim=1), first.amax(dim=1)
    span = (high - low).amax(dim=1) + 2
    result = table.new_empty(len(points), table.shape[1])
    smaller = 0
    for window in (*[w for w in WINDOW_TEXELS if w * w < 4 * points.shape[1]], plane):
        rows = ((span > smaller) & (span <= window)).nonzero()[:, 0]
        if len(rows):
            if window == plane:
                index, weight = _entries_per_sample(position[rows], first[rows], plane)
            else:
                index, weight = _entries_per_window(position[rows], low[rows], window, plane)
            result[rows] = weighted_rows(table, index, weight.to(table.dtype))
        smaller = window
    return result


def _entries_per_window(
    position: Tensor, low: Tensor, window: int, plane: int
) -> tuple[Tensor, Tensor]:
    start = low.clamp(max=plane - window)
    steps = torch.arange(window, device=position.device)
    texel = start[:, None, :] + steps[None, :, None]  # N x S x 3
    hat = (1 - (position[:, :, None, :] - texel[:, None, :, :]).abs()).clamp(min=0)
    indices, weights = [], []
    for number, (column, row) in enumerate(PLANE_AXES):
        share = hat[..., row].transpose(1, 2) @ hat[..., column] / position.shape[1]
        rows = texel[:, :, None, row] * plane + texel[:, None, :, column]
        indices.append((rows.long() + number * plane * plane).flatten(1))
        weights.append(share.flatten(1))
    return torch.cat(indices, dim=1), torch.cat(weights, dim=1)


def _entries_per_sample(position: Tensor, first: Tensor, plane: int) -> tuple[Tensor, Tensor]:
    fraction = position - first
    cell = first.long()
    indices, weights = [], []
    for number, (column, row) in enumerate(PLANE_AXES):
        for right in (0, 1):
            for below in (0, 1):
                across = fraction[..., column] if right else 1 - fraction[..., column]
                down = fraction[..., row] if below else 1 - fraction[..., row]
                flat = (cell[..., row] + below) * plane + cell[..., column] + right
                indices.append(flat + number * plane * plane)
                weights.append(across * down / position.shape[1])
    return torch.cat(indices, dim=1), torch.cat(weights, dim=1)
