"""Face means as sums of table rows, against torch's own plane sampling."""

import pytest
import torch
import torch.nn.functional as functional
from partuv_worker.features.partfield.lookup import WINDOW_TEXELS, point_means
from torch import Tensor

PLANE = 32


def sampled(planes: Tensor, points: Tensor) -> Tensor:
    """The same means through `grid_sample`: planes 3 x R x R x C, points N x K x 3."""
    images = planes.permute(0, 3, 1, 2)
    places = torch.stack([points[..., [0, 1]], points[..., [1, 2]], points[..., [0, 2]]])
    values = functional.grid_sample(images, places, padding_mode="border", align_corners=True)
    return values.sum(dim=0).mean(dim=2).T


def points_within(texels: float, rows: int, samples: int) -> Tensor:
    """Rows of points no further apart than a number of texels."""
    generator = torch.Generator().manual_seed(3)
    centre = torch.rand(rows, 1, 3, generator=generator, dtype=torch.float64) * 2.2 - 1.1
    spread = torch.rand(rows, samples, 3, generator=generator, dtype=torch.float64)
    return centre + spread * 2 / (PLANE - 1) * texels


@pytest.mark.parametrize("texels", [0.0, 0.3, 0.9, 1.7, 2.5, 4.4, 9.0, 31.0])
@pytest.mark.parametrize("samples", [1, 2, 10, 40])
def test_equals_plane_sampling(texels: float, samples: int) -> None:
    planes = torch.randn(
        3, PLANE, PLANE, 5, generator=torch.Generator().manual_seed(1), dtype=torch.float64
    )
    points = points_within(texels, 50, samples)
    means = point_means(planes.reshape(-1, 5), points, PLANE)
    torch.testing.assert_close(means, sampled(planes, points), rtol=1e-12, atol=1e-12)


def test_faces_of_all_sizes_in_one_call_keep_their_rows() -> None:
    planes = torch.randn(
        3, PLANE, PLANE, 4, generator=torch.Generator().manual_seed(2), dtype=torch.float64
    )
    sizes = [0.2, *(w - 0.5 for w in WINDOW_TEXELS), 20.0]
    points = torch.cat([points_within(size, 9, 12) for size in sizes])
    order = torch.randperm(len(points), generator=torch.Generator().manual_seed(4))
    means = point_means(planes.reshape(-1, 4), points[order], PLANE)
    torch.testing.assert_close(means, sampled(planes, points[order]), rtol=1e-12, atol=1e-12)


def test_corner_values_are_read_at_the_corner() -> None:
    planes = torch.zeros(3, PLANE, PLANE, 1)
    planes[0, 0, -1], planes[1, -1, 0], planes[2, -1, -1] = 1.0, 10.0, 100.0
    x, y, z = 1.0, -1.0, 1.0  # plane xy: column x, row y; yz: column y, row z; xz: column x, row z
    corner = torch.tensor([[[x, y, z]]])
    assert point_means(planes.reshape(-1, 1), corner, PLANE).item() == 111.0
