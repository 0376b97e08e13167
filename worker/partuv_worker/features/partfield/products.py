"""Matrix products by the fastest float32 kernel that torch carries."""

import torch
import torch.nn.functional as functional
from torch import Tensor, nn


def linear(x: Tensor, weight: Tensor, bias: Tensor | None = None) -> Tensor:
    """`functional.linear`, on the CPU as a 1 x 1 convolution.

    torch sends float32 matrix products to MKL, which keeps to AVX2 on processors that are not
    Intel's, and convolutions to oneDNN, which uses AVX-512 on all: 1.6 to 2 times faster there.
    """
    if x.device.type != "cpu" or x.dtype != torch.float32 or torch.is_autocast_enabled("cpu"):
        return functional.linear(x, weight, bias)
    image = x.reshape(1, -1, 1, x.shape[-1]).permute(0, 3, 1, 2)
    product = functional.conv2d(image, weight[:, :, None, None], bias)
    return product.permute(0, 2, 3, 1).reshape(*x.shape[:-1], weight.shape[0])


class Linear(nn.Linear):
    """`nn.Linear` through `linear`."""

    def forward(self, input: Tensor) -> Tensor:
        return linear(input, self.weight, self.bias)
