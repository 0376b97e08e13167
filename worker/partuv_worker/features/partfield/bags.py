"""Sums over bins and weighted table look-ups, both as embedding bags.

An embedding bag adds rows one after the other for each output row: the order of the additions is
fixed (no atomics), rows are contiguous, and the result may lie on any device.
"""

import torch
import torch.nn.functional as functional
from torch import Tensor


def mean_by_bin(rows: Tensor, bins: Tensor, bin_count: int) -> Tensor:
    """Mean of the rows (N x C) that fall into each bin (N); bins without rows are 0."""
    order = torch.argsort(bins, stable=True)
    starts = torch.searchsorted(
        bins[order], torch.arange(bin_count, device=bins.device, dtype=bins.dtype)
    )
    return functional.embedding_bag(order, rows, starts, mode="mean")


def weighted_rows(table: Tensor, index: Tensor, weight: Tensor) -> Tensor:
    """Sum over k of weight[i, k] * table[index[i, k]]: table T x C, index and weight N x K."""
    return functional.embedding_bag(index, table, mode="sum", per_sample_weights=weight)
