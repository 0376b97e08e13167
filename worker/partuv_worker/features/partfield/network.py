"""PartField (Liu et al. 2025, arXiv 2504.11451): surface points to three planes of part features.

Module and parameter names are those of the published checkpoint, so that it loads strictly.
"""

from itertools import pairwise

import torch
from torch import Tensor, nn

from partuv_worker.features.partfield.point_voxel import PointEncoder, scatter_to_planes
from partuv_worker.features.partfield.shape import NetworkShape
from partuv_worker.features.partfield.transformer import TriplaneTransformer
from partuv_worker.features.partfield.unet import PlaneUNet


class SdfDecoder(nn.Module):
    """A head that only training evaluates; it holds the checkpoint's keys."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        widths = [channels] * 7 + [1]
        layers: list[nn.Module] = []
        for width_in, width_out in pairwise(widths):
            layers += [nn.Linear(width_in, width_out, bias=False), nn.ReLU()]
        self.layers = nn.Sequential(*layers[:-1])


class PlaneEncoder(nn.Module):
    """Surface points to planes 3 x R x R x C."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        self.plane = shape.plane
        self.pc_encoder = PointEncoder(shape)
        self.unet_encoder = PlaneUNet(shape)

    def forward(self, points: Tensor) -> Tensor:
        planes = scatter_to_planes(self.pc_encoder(points), points, self.plane)
        out: Tensor = self.unet_encoder(planes)
        return out


class PartFieldNetwork(nn.Module):
    """Points N x 3 in [-1, 1] to planes xy, yz, xz of the channels asked for."""

    def __init__(self, shape: NetworkShape | None = None) -> None:
        super().__init__()
        self.shape = shape or NetworkShape()
        self.pvcnn = PlaneEncoder(self.shape)
        self.triplane_transformer = TriplaneTransformer(self.shape)
        self.sdf_decoder = SdfDecoder(self.shape.sdf_channels)
        self.logit_scale = nn.Parameter(torch.empty(1))

    def forward(self, points: Tensor) -> Tensor:
        """The part planes, 3 x R x R x part_channels."""
        return self.planes(points, slice(self.shape.sdf_channels, self.shape.channels))

    def planes(self, points: Tensor, channels: slice) -> Tensor:
        """3 x R x R x channels, rows and columns as `PLANE_AXES` says."""
        out: Tensor = self.triplane_transformer(self.pvcnn(points), channels)
        return out


def expected_parameters(shape: NetworkShape | None = None) -> dict[str, tuple[int, ...]]:
    """Name and shape of every tensor that a checkpoint must hold; allocates nothing."""
    with torch.device("meta"):
        network = PartFieldNetwork(shape)
    return {name: tuple(tensor.shape) for name, tensor in network.state_dict().items()}
