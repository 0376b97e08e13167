"""Matrix products by the fastest float32 kernel that torch carries."""

import torch
import torch.nn.functional as functional
from torch import Tensor, nn

# With one thread torch keeps 1 x 1 convolutions of smaller batches from oneDNN.
_BATCH = 16


def linear(x: Tensor, weight: Tensor, bias: Tensor | None = None) -> Tensor:
    """`functional.linear`, on the CPU as a 1 x 1 convolution.

    torch sends float32 matrix products to MKL, which keeps to AVX2 on processors that are not
    Intel's, and convolutions to oneDNN, which uses AVX-512 on all: 1.9 times faster there.
    """
    if x.device.type != "cpu" or x.dtype != torch.float32 or torch.is_autocast_enabled("cpu"):
        return functional.linear(x, weight, bias)
    rows, channels = x.shape[:-1].numel(), x.shape[-1]
    batch = _BATCH if rows % _BATCH == 0 else 1
    images = x.reshape(batch, rows // batch, 1, channels).permute(0, 3, 1, 2)
    product = functional.conv2d(images, weight[:, :, None, None], bias)
    return product.permute(0, 2, 3, 1).reshape(*x.shape[:-1], weight.shape[0])


class Linear(nn.Linear):
    """`nn.Linear` through `linear`."""

    def forward(self, input: Tensor) -> Tensor:
        return linear(input, self.weight, self.bias)
