"""Sizes of the network; the defaults are those of the published checkpoint."""

from dataclasses import dataclass


@dataclass(frozen=True)
class NetworkShape:
    """What decides the shape of every parameter. Tests run the same arithmetic at tiny sizes."""

    plane: int = 128  # texels along one side of a feature plane
    voxel_grids: tuple[int, ...] = (32, 16, 16, 8)  # cells per side, one per point-voxel block
    point_channels: tuple[int, ...] = (256, 128, 128, 256)
    unet_channels: tuple[int, ...] = (32, 64, 128)
    norm_groups: int = 32
    width: int = 1024  # of a transformer token
    heads: int = 8
    layers: int = 6
    channels: int = 512  # of the output planes: the first `sdf_channels`, then the part features
    sdf_channels: int = 64

    @property
    def plane_channels(self) -> int:
        """Channels of the planes between the point encoder and the transformer."""
        return self.point_channels[0]

    @property
    def token_plane(self) -> int:
        """Tokens along one side of a plane: two halvings of the texels."""
        return self.plane // 4

    @property
    def part_channels(self) -> int:
        """Channels of the part feature."""
        return self.channels - self.sdf_channels
