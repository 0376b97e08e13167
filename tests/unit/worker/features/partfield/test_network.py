"""The network against a second implementation, in loops over NumPy arrays, at a tiny size."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from partuv_worker.features.partfield.lookup import point_means
from partuv_worker.features.partfield.network import PartFieldNetwork, expected_parameters
from partuv_worker.features.partfield.shape import NetworkShape

Array = NDArray[np.float64]
Weights = dict[str, Array]


def cloud(count: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).uniform(-1, 1, (count, 3)) * [0.9, 0.7, 0.5]


def test_planes_and_features_equal_the_loops(
    tiny_network: PartFieldNetwork, tiny_shape: NetworkShape
) -> None:
    points, queries = cloud(70), cloud(20, seed=2) * 1.3
    network = tiny_network.double()
    weights = {name: tensor.numpy() for name, tensor in network.state_dict().items()}
    with torch.inference_mode():
        planes = network.planes(torch.from_numpy(points), slice(0, tiny_shape.channels))
        part = network(torch.from_numpy(points))
        table = part.reshape(-1, tiny_shape.part_channels)
        features = point_means(table, torch.from_numpy(queries)[:, None], tiny_shape.plane)

    expected = planes_by_loops(weights, tiny_shape, points)
    np.testing.assert_allclose(planes.permute(0, 3, 1, 2), expected, rtol=1e-9, atol=1e-9)
    expected_part = expected[:, tiny_shape.sdf_channels :]
    np.testing.assert_allclose(part.permute(0, 3, 1, 2), expected_part, rtol=1e-9, atol=1e-9)
    for query, row in zip(queries, features, strict=True):
        np.testing.assert_allclose(
            row, feature_by_loops(expected_part, query), rtol=1e-9, atol=1e-9
        )


def test_single_precision_stays_close(
    tiny_network: PartFieldNetwork, tiny_shape: NetworkShape
) -> None:
    points = torch.from_numpy(cloud(500)).float()
    with torch.inference_mode():
        single = tiny_network(points)
        double = tiny_network.double()(points.double())
    assert ((single - double).square().mean() / double.square().mean()).sqrt() < 1e-5


def test_the_order_of_the_points_does_not_matter(tiny_network: PartFieldNetwork) -> None:
    points = torch.from_numpy(cloud(300))
    network = tiny_network.double()
    with torch.inference_mode():
        difference = network(points) - network(points.flip(0))
    assert difference.abs().max() < 1e-9


def test_every_point_counts(tiny_network: PartFieldNetwork) -> None:
    points = torch.from_numpy(cloud(40)).float()
    moved = points.clone()
    moved[7] = torch.tensor([0.8, -0.6, 0.4])
    with torch.inference_mode():
        assert (tiny_network(points) - tiny_network(moved)).abs().max() > 1e-3


def test_published_size() -> None:
    parameters = expected_parameters()
    assert len(parameters) == 203
    assert sum(int(np.prod(shape)) for shape in parameters.values()) == 106_914_881
    assert parameters["triplane_transformer.pos_embed"] == (1, 3072, 1024)
    assert parameters["triplane_transformer.transformer.layers.5.self_attn.in_proj_weight"] == (
        3072,
        1024,
    )
    assert parameters["pvcnn.pc_encoder.encoder.0.point_features.layers.0.weight"] == (256, 8, 1)
    assert parameters["pvcnn.unet_encoder.up_convs.0.norm1.weight"] == (192,)
    assert parameters["sdf_decoder.layers.12.weight"] == (1, 64)


# The second implementation: channels first, one point or plane at a time.


def planes_by_loops(w: Weights, shape: NetworkShape, points: Array) -> Array:
    fused = block_by_loops(w, shape.voxel_grids[0], points)
    planes = scatter_by_loops(fused, points, shape.plane)
    planes = unet_by_loops(w, shape, planes)
    return transformer_by_loops(w, shape, planes)


def block_by_loops(w: Weights, r: int, points: Array) -> Array:
    prefix = "pvcnn.pc_encoder.encoder.0."
    sums, counts = np.zeros((8, r, r, r)), np.zeros((r, r, r))
    positions = np.clip((points + 1) / 2 * r, 0, r - 1)
    features = np.stack([[*p, *(2 * p), 0.0, 0.0] for p in points])
    for feature, position in zip(features, positions, strict=True):
        cell = tuple(round(float(g)) for g in position)
        sums[(slice(None), *cell)] += feature
        counts[cell] += 1
    volume = sums / np.maximum(counts, 1)
    for layer in (0, 3):
        name = f"{prefix}voxel_layers.{layer}"
        volume = convolve(volume, w[f"{name}.weight"], w[f"{name}.bias"])
        volume = standardise(volume.reshape(len(volume), -1), 1e-4).reshape(volume.shape)
        volume = np.where(volume > 0, volume, 0.1 * volume)
    matrix = w[f"{prefix}point_features.layers.0.weight"][:, :, 0]
    bias = w[f"{prefix}point_features.layers.0.bias"]
    branch = standardise(matrix @ features.T + bias[:, None], 1e-5).clip(min=0)
    read = np.stack([trilinear(volume, position[::-1]) for position in positions], axis=1)
    return read + branch


def trilinear(volume: Array, position: Array) -> Array:
    low = np.minimum(np.floor(position), volume.shape[1] - 2).astype(int)
    t = position - low
    total = np.zeros(len(volume))
    for i in (0, 1):
        for j in (0, 1):
            for k in (0, 1):
                share = abs(1 - i - t[0]) * abs(1 - j - t[1]) * abs(1 - k - t[2])
                total += share * volume[:, low[0] + i, low[1] + j, low[2] + k]
    return total


def scatter_by_loops(features: Array, points: Array, plane: int) -> Array:
    sums = np.zeros((3, len(features), plane, plane))
    counts = np.zeros((3, plane, plane))
    for feature, point in zip(features.T, points, strict=True):
        cell = [int(plane * (x / 2 / (1 + 1e-5) + 0.5)) for x in point]
        for number, (column, row) in enumerate(((0, 1), (1, 2), (0, 2))):
            sums[number, :, cell[row], cell[column]] += feature
            counts[number, cell[row], cell[column]] += 1
    return sums / np.maximum(counts, 1)[:, None]


def unet_by_loops(w: Weights, shape: NetworkShape, planes: Array) -> Array:
    prefix, groups = "pvcnn.unet_encoder.", shape.norm_groups

    def norm(x: Array, name: str) -> Array:
        flat = standardise(x.reshape(groups, -1), 1e-6).reshape(x.shape)
        return flat * w[f"{name}.weight"][:, None, None] + w[f"{name}.bias"][:, None, None]

    def block(x: Array, name: str) -> Array:
        def conv(x: Array, part: str) -> Array:
            return convolve(x, w[f"{name}.{part}.weight"], w[f"{name}.{part}.bias"])

        h = conv(swish(norm(x, f"{name}.norm1")), "conv1")
        h = aware(swish(norm(h, f"{name}.norm_mid")), f"{name}.conv_3daware.plane_convs")
        h = conv(swish(norm(h, f"{name}.norm2")), "conv2")
        return conv(x, "nin_shortcut") + h

    def aware(x: Array, name: str) -> Array:
        a = np.split(x, 3, axis=1)
        a[2] = a[2].transpose(0, 2, 1)
        mixed = []
        for i in range(3):
            one, other = a[(i + 1) % 3].mean(axis=2), a[(i + 2) % 3].mean(axis=1)
            ones = np.ones_like(a[i])
            stack = np.concatenate([a[i], ones * one[:, None, :], ones * other[:, :, None]])
            mixed.append(convolve(stack, w[f"{name}.{i}.weight"], w[f"{name}.{i}.bias"]))
        mixed[2] = mixed[2].transpose(0, 2, 1)
        return np.concatenate(mixed, axis=1)

    x = np.concatenate(list(planes), axis=1)
    skip0 = block(x, f"{prefix}down_convs.0.block")
    skip1 = block(halve(skip0, np.mean), f"{prefix}down_convs.1.block")
    low = block(halve(skip1, np.mean), f"{prefix}down_convs.2.block")
    for number, skip in enumerate((skip1, skip0)):
        joined = np.concatenate([low.repeat(2, axis=1).repeat(2, axis=2), skip])
        joined = norm(joined, f"{prefix}up_convs.{number}.norm1")
        low = block(joined, f"{prefix}up_convs.{number}.block")
    out = swish(norm(low, f"{prefix}norm_out"))
    out = convolve(out, w[f"{prefix}conv_final.weight"], w[f"{prefix}conv_final.bias"])
    return np.stack(np.split(out, 3, axis=1))


def transformer_by_loops(w: Weights, shape: NetworkShape, planes: Array) -> Array:
    prefix, side, width = "triplane_transformer.", shape.token_plane, shape.width
    tokens = []
    for plane in planes:
        x = plane
        for layer in (0, 3):
            name = f"{prefix}downsampler.{layer}"
            x = halve(convolve(x, w[f"{name}.weight"], w[f"{name}.bias"]).clip(min=0), np.max)
        tokens += [x[:, row, column] for row in range(side) for column in range(side)]
    x = np.stack(tokens) + w[f"{prefix}pos_embed"][0]

    def norm(x: Array, name: str) -> Array:
        return standardise(x, 1e-6) * w[f"{name}.weight"] + w[f"{name}.bias"]

    for layer in range(shape.layers):
        name = f"{prefix}transformer.layers.{layer}"
        packed = norm(x, f"{name}.norm1") @ w[f"{name}.self_attn.in_proj_weight"].T
        queries, keys, values = np.split(packed, 3, axis=1)
        heads = []
        for head in range(shape.heads):
            part = slice(head * width // shape.heads, (head + 1) * width // shape.heads)
            scores = queries[:, part] @ keys[:, part].T / np.sqrt(width / shape.heads)
            scores = np.exp(scores - scores.max(axis=1, keepdims=True))
            heads.append(scores / scores.sum(axis=1, keepdims=True) @ values[:, part])
        x = x + np.concatenate(heads, axis=1) @ w[f"{name}.self_attn.out_proj.weight"].T
        hidden = norm(x, f"{name}.norm2") @ w[f"{name}.mlp.0.weight"].T + w[f"{name}.mlp.0.bias"]
        erf = torch.erf(torch.from_numpy(hidden / np.sqrt(2))).numpy()
        x = x + (hidden * (1 + erf) / 2) @ w[f"{name}.mlp.3.weight"].T + w[f"{name}.mlp.3.bias"]
    x = norm(x, f"{prefix}transformer.norm").reshape(3, side, side, width)

    result = np.zeros((3, shape.channels, shape.plane, shape.plane))
    for plane, row, column in np.ndindex(3, shape.plane, shape.plane):
        kernel = w[f"{prefix}upsampler.weight"][:, :, row % 4, column % 4]
        up = x[plane, row // 4, column // 4] @ kernel + w[f"{prefix}upsampler.bias"]
        hidden = w[f"{prefix}mlp.0.weight"] @ planes[plane, :, row, column]
        hidden = (hidden + w[f"{prefix}mlp.0.bias"]).clip(min=0)
        short = w[f"{prefix}mlp.2.weight"] @ hidden + w[f"{prefix}mlp.2.bias"]
        result[plane, :, row, column] = up + short
    return result


def feature_by_loops(planes: Array, query: Array) -> Array:
    side = planes.shape[2]
    total = np.zeros(planes.shape[1])
    position = np.clip((query + 1) / 2 * (side - 1), 0, side - 1)
    for plane, (column, row) in zip(planes, ((0, 1), (1, 2), (0, 2)), strict=True):
        for i in range(side):
            for j in range(side):
                share = max(0.0, 1 - abs(position[row] - i)) * max(
                    0.0, 1 - abs(position[column] - j)
                )
                total += share * plane[:, i, j]
    return total


def convolve(x: Array, weight: Array, bias: Array) -> Array:
    pad = weight.shape[2] // 2
    padded = np.pad(x, [(0, 0)] + [(pad, pad)] * (x.ndim - 1))
    out = np.zeros((len(weight), *x.shape[1:])) + bias.reshape(-1, *[1] * (x.ndim - 1))
    for offset in np.ndindex(*weight.shape[2:]):
        window: Any = tuple(slice(o, o + n) for o, n in zip(offset, x.shape[1:], strict=True))
        out += np.tensordot(weight[(..., *offset)], padded[(slice(None), *window)], axes=1)
    return out


def standardise(x: Array, eps: float) -> Array:
    """Rows to mean 0 and variance 1."""
    result: Array = (x - x.mean(axis=1, keepdims=True)) / np.sqrt(
        x.var(axis=1, keepdims=True) + eps
    )
    return result


def halve(x: Array, pool: Any) -> Array:
    channels, rows, columns = x.shape
    result: Array = pool(x.reshape(channels, rows // 2, 2, columns // 2, 2), axis=(2, 4))
    return result


def swish(x: Array) -> Array:
    result: Array = x / (1 + np.exp(-x))
    return result
