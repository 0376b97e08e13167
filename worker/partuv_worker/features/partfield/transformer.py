"""Transformer over three planes with a per-texel short cut (Hong et al. 2023, LRM)."""

import torch
import torch.nn.functional as functional
from torch import Tensor, nn

from partuv_worker.features.partfield.products import Linear, linear
from partuv_worker.features.partfield.shape import NetworkShape


class SelfAttention(nn.Module):
    """Multi-head self-attention without biases; parameter names as in torch's own module."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.in_proj_weight = nn.Parameter(torch.empty(3 * width, width))
        self.out_proj = Linear(width, width, bias=False)

    def forward(self, x: Tensor) -> Tensor:
        batch, tokens, width = x.shape
        packed = linear(x, self.in_proj_weight)
        query, key, value = packed.view(batch, tokens, 3, self.heads, -1).permute(2, 0, 3, 1, 4)
        attended = functional.scaled_dot_product_attention(query, key, value)
        out: Tensor = self.out_proj(attended.transpose(1, 2).reshape(batch, tokens, width))
        return out


class Layer(nn.Module):
    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.norm1 = nn.LayerNorm(width, eps=1e-6)
        self.self_attn = SelfAttention(width, heads)
        self.norm2 = nn.LayerNorm(width, eps=1e-6)
        # The identities stand where training has its dropout: the keys are mlp.0 and mlp.3.
        self.mlp = nn.Sequential(
            Linear(width, 4 * width), nn.GELU(), nn.Identity(), Linear(4 * width, width)
        )

    def forward(self, x: Tensor) -> Tensor:
        x = x + self.self_attn(self.norm1(x))
        out: Tensor = x + self.mlp(self.norm2(x))
        return out


class Transformer(nn.Module):
    def __init__(self, width: int, heads: int, layers: int) -> None:
        super().__init__()
        self.layers = nn.ModuleList(Layer(width, heads) for _ in range(layers))
        self.norm = nn.LayerNorm(width, eps=1e-6)

    def forward(self, x: Tensor) -> Tensor:
        for layer in self.layers:
            x = layer(x)
        out: Tensor = self.norm(x)
        return out


class TriplaneTransformer(nn.Module):
    """Planes 3 x R x R x C to output planes 3 x R x R x channels."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        self.token_plane = shape.token_plane
        width = shape.width
        self.downsampler = nn.Sequential(
            nn.Conv2d(shape.plane_channels, width, 3, padding=1),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(2),
            nn.Conv2d(width, width, 3, padding=1),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(2),
        )
        self.pos_embed = nn.Parameter(torch.empty(1, 3 * shape.token_plane**2, width))
        self.transformer = Transformer(width, shape.heads, shape.layers)
        self.upsampler = nn.ConvTranspose2d(width, shape.channels, 4, stride=4)
        self.mlp = nn.Sequential(
            Linear(shape.plane_channels, shape.channels),
            nn.ReLU(inplace=True),
            Linear(shape.channels, shape.channels),
        )

    def forward(self, planes: Tensor, channels: slice) -> Tensor:
        tokens = self.transformer(self.tokens(planes)).to(planes.dtype)
        result = self.upsample(tokens, channels)
        for texels, plane in zip(result, planes, strict=True):
            texels.add_(self.shortcut(plane, channels))
        return result

    def tokens(self, planes: Tensor) -> Tensor:
        """1 x tokens x width, ordered plane, row, column."""
        # One plane after the other: the first convolution alone makes 67 MB of each.
        low = [self.downsampler(plane[None].permute(0, 3, 1, 2)) for plane in planes]
        ordered = torch.cat([plane.flatten(2).transpose(1, 2) for plane in low], dim=1)
        return self.pos_embed + ordered

    def upsample(self, tokens: Tensor, channels: slice) -> Tensor:
        """The transposed convolution, whose windows do not overlap, as one matrix product."""
        side, weight = self.token_plane, self.upsampler.weight[:, channels]
        bias = self.upsampler.bias
        assert bias is not None
        matrix = weight.permute(2, 3, 1, 0).reshape(-1, weight.shape[0])
        patches = linear(tokens, matrix, bias[channels].repeat(16)).to(tokens.dtype)
        texels = patches.reshape(3, side, side, 4, 4, -1).permute(0, 1, 3, 2, 4, 5)
        return texels.reshape(3, 4 * side, 4 * side, -1)

    def shortcut(self, planes: Tensor, channels: slice) -> Tensor:
        """The per-texel perceptron; only the rows of its last layer that are asked for."""
        last = self.mlp[2]
        assert isinstance(last, Linear)
        hidden = self.mlp[:2](planes)
        return linear(hidden, last.weight[channels], last.bias[channels]).to(planes.dtype)
