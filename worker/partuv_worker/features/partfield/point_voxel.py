"""Point-voxel encoder (Liu et al. 2019, PVCNN) and its mean projection onto three planes.

Points are rows throughout: features are N x C, not C x N.
"""

import torch
import torch.nn.functional as functional
from torch import Tensor, nn

from partuv_worker.features.partfield.bags import mean_by_bin, weighted_rows
from partuv_worker.features.partfield.shape import NetworkShape

INPUT_CHANNELS = 8
# (column axis, row axis) of the planes xy, yz, xz.
PLANE_AXES = ((0, 1), (1, 2), (0, 2))


def point_features(points: Tensor) -> Tensor:
    """N x 8 input features of N x 3 points: the position, its double and two zeros."""
    return torch.cat([points, 2 * points, points.new_zeros(len(points), 2)], dim=1)


def grid_position(points: Tensor, grid: int) -> Tensor:
    """Fractional cell index of points in [-1, 1]; cell k is centred on index k."""
    return ((points + 1) / 2 * grid).clamp(0, grid - 1)


def voxelise(features: Tensor, position: Tensor, grid: int) -> Tensor:
    """Mean feature of the points in each cell, grid^3 x C, cells ordered x, y, z."""
    cell = position.round().long()
    flat = (cell[:, 0] * grid + cell[:, 1]) * grid + cell[:, 2]
    return mean_by_bin(features, flat, grid**3)


def devoxelise(volume: Tensor, position: Tensor, grid: int) -> Tensor:
    """Trilinear reading of a grid^3 x C volume at fractional cell indices, N x C.

    The volume's axes are x, y, z but it is read at (z, y, x): the exchange is in the network the
    weights were trained with.
    """
    swapped = position.flip(1)
    base = swapped.floor().clamp(max=grid - 2)
    fraction = swapped - base
    corner = torch.tensor(
        [[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], device=position.device
    )
    cell = base.long()[:, None, :] + corner
    weight = torch.where(corner == 1, fraction[:, None, :], 1 - fraction[:, None, :]).prod(dim=2)
    index = (cell[..., 0] * grid + cell[..., 1]) * grid + cell[..., 2]
    return weighted_rows(volume, index, weight)


def scatter_to_planes(features: Tensor, points: Tensor, plane: int) -> Tensor:
    """Mean feature of the points over each texel: 3 x plane x plane x C, planes xy, yz, xz."""
    unit = ((points + 1) / 2 - 0.5) / (1 + 1e-5) + 0.5
    unit = torch.where(unit >= 1, 1 - 1e-5, unit).clamp(min=0)
    cell = (unit * plane).floor().long()
    planes = [
        mean_by_bin(features, cell[:, column] + plane * cell[:, row], plane * plane)
        for column, row in PLANE_AXES
    ]
    return torch.stack(planes).reshape(3, plane, plane, -1)


class PointBranch(nn.Module):
    """A linear map of each point, normalised over the points."""

    def __init__(self, channels_in: int, channels_out: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(nn.Conv1d(channels_in, channels_out, 1))

    def forward(self, features: Tensor) -> Tensor:
        convolution = self.layers[0]
        assert isinstance(convolution, nn.Conv1d)
        # The variance of a linear map follows from the covariance of its few inputs, and its bias
        # cancels: so one map of the centred inputs is all.
        inputs, matrix = features.double(), convolution.weight[:, :, 0].double()
        centred = inputs - inputs.mean(dim=0)
        covariance = centred.T @ centred / len(centred)
        variance = ((matrix @ covariance) * matrix).sum(dim=1, keepdim=True)
        matrix = matrix * torch.rsqrt(variance + 1e-5)
        mapped = functional.linear(centred.to(features.dtype), matrix.to(features.dtype))
        return mapped.to(features.dtype).relu_()


class PointVoxelBlock(nn.Module):
    """Two convolutions over the points' voxels, read back at the points, plus the point branch."""

    def __init__(self, channels_in: int, channels_out: int, grid: int) -> None:
        super().__init__()
        self.grid = grid
        self.voxel_layers = nn.Sequential(
            nn.Conv3d(channels_in, channels_out, 3, padding=1),
            nn.InstanceNorm3d(channels_out, eps=1e-4),
            nn.LeakyReLU(0.1),
            nn.Conv3d(channels_out, channels_out, 3, padding=1),
            nn.InstanceNorm3d(channels_out, eps=1e-4),
            nn.LeakyReLU(0.1),
        )
        self.point_features = PointBranch(channels_in, channels_out)

    def forward(self, features: Tensor, points: Tensor) -> Tensor:
        grid = self.grid
        position = grid_position(points, grid)
        cells = voxelise(features, position, grid)
        volume = cells.reshape(1, grid, grid, grid, -1).permute(0, 4, 1, 2, 3)
        volume = self.voxel_layers(volume).to(features.dtype)
        rows = volume.permute(0, 2, 3, 4, 1).reshape(grid**3, -1)
        branch: Tensor = self.point_features(features)
        return branch.add_(devoxelise(rows, position, grid))


class PointEncoder(nn.Module):
    """Only the first block reaches the planes; the others exist for the checkpoint's keys."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        inputs = (INPUT_CHANNELS, *shape.point_channels[:-1])
        self.encoder = nn.ModuleList(
            PointVoxelBlock(channels_in, channels_out, grid)
            for channels_in, channels_out, grid in zip(
                inputs, shape.point_channels, shape.voxel_grids, strict=True
            )
        )

    def forward(self, points: Tensor) -> Tensor:
        fused: Tensor = self.encoder[0](point_features(points), points)
        return fused
