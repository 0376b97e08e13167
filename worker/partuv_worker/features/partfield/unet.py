"""3D-aware U-Net over three planes (Wang et al. 2023, Rodin's roll-out).

The planes are stacked along the rows into one image, C x 3R x R ("rolled"): convolutions leak over
the seams between planes and norms share their statistics, as in the trained network.
"""

from itertools import pairwise

import torch
import torch.nn.functional as functional
from torch import Tensor, nn

from partuv_worker.features.partfield.shape import NetworkShape


class PlaneMixer(nn.Module):
    """Shows each plane the two others, averaged along one of their axes."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.plane_convs = nn.ModuleList(nn.Conv2d(3 * channels, channels, 1) for _ in range(3))

    def forward(self, rolled: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        first, second, third = rolled.chunk(3, dim=2)
        planes = (first, second, third.transpose(2, 3))
        # The pooled axes do not match geometrically; the weights were trained with them as is.
        mixed = []
        for i, (plane, convolution) in enumerate(zip(planes, self.plane_convs, strict=True)):
            by_row = planes[(i + 1) % 3].mean(dim=3)
            by_column = planes[(i + 2) % 3].mean(dim=2)
            along_columns = by_row[:, :, None, :].expand_as(plane)
            along_rows = by_column[:, :, :, None].expand_as(plane)
            mixed.append(convolution(torch.cat([plane, along_columns, along_rows], dim=1)))
        return mixed[0], mixed[1], mixed[2].transpose(2, 3)


class ResidualBlock(nn.Module):
    """Convolution, plane mixing, convolution, and a 1 x 1 short cut around them."""

    def __init__(self, channels_in: int, channels_out: int, groups: int) -> None:
        super().__init__()
        self.norm1 = nn.GroupNorm(groups, channels_in, eps=1e-6)
        self.conv1 = nn.Conv2d(channels_in, channels_out, 3, padding=1)
        self.norm_mid = nn.GroupNorm(groups, channels_out, eps=1e-6)
        self.conv_3daware = PlaneMixer(channels_out)
        self.norm2 = nn.GroupNorm(groups, channels_out, eps=1e-6)
        self.conv2 = nn.Conv2d(channels_out, channels_out, 3, padding=1)
        self.nin_shortcut = nn.Conv2d(channels_in, channels_out, 1)

    def forward(self, x: Tensor) -> Tensor:
        h = self.conv1(functional.silu(self.norm1(x)))
        h = torch.cat(self.conv_3daware(functional.silu(self.norm_mid(h))), dim=2)
        h = self.conv2(functional.silu(self.norm2(h)))
        out: Tensor = self.nin_shortcut(x) + h
        return out


class DownStep(nn.Module):
    def __init__(self, channels_in: int, channels_out: int, groups: int) -> None:
        super().__init__()
        self.block = ResidualBlock(channels_in, channels_out, groups)

    def forward(self, x: Tensor) -> Tensor:
        out: Tensor = self.block(x)
        return out


class UpStep(nn.Module):
    """Doubles the resolution, joins the skip connection and normalises before the block."""

    def __init__(self, channels_low: int, channels_skip: int, groups: int) -> None:
        super().__init__()
        joined = channels_low + channels_skip
        self.norm1 = nn.GroupNorm(groups, joined, eps=1e-6)
        self.block = ResidualBlock(joined, channels_skip, groups)

    def forward(self, low: Tensor, skip: Tensor) -> Tensor:
        joined = torch.cat([functional.interpolate(low, scale_factor=2.0), skip], dim=1)
        out: Tensor = self.block(self.norm1(joined))
        return out


class PlaneUNet(nn.Module):
    """Planes 3 x R x R x C in and out."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        groups = shape.norm_groups
        down = (shape.plane_channels, *shape.unet_channels)
        self.down_convs = nn.ModuleList(DownStep(a, b, groups) for a, b in pairwise(down))
        up = shape.unet_channels[::-1]
        self.up_convs = nn.ModuleList(UpStep(a, b, groups) for a, b in pairwise(up))
        self.norm_out = nn.GroupNorm(groups, up[-1], eps=1e-6)
        self.conv_final = nn.Conv2d(up[-1], shape.plane_channels, 1)

    def forward(self, planes: Tensor) -> Tensor:
        _, rows, columns, channels = planes.shape
        # Channel-first memory: torch's channels-last group norm sums 400 000 squares in one float32
        # run and costs two digits here.
        x = planes.reshape(1, 3 * rows, columns, channels).permute(0, 3, 1, 2).contiguous()
        skips: list[Tensor] = []
        for step in self.down_convs:
            # Pooling the rolled image is pooling each plane: its rows are an even number.
            x = step(functional.avg_pool2d(x, 2) if skips else x)
            skips.append(x)
        for step, skip in zip(self.up_convs, skips[-2::-1], strict=True):
            x = step(x, skip)
        out: Tensor = self.conv_final(functional.silu(self.norm_out(x)))
        return out.permute(0, 2, 3, 1).reshape(3, rows, columns, channels).to(planes.dtype)
