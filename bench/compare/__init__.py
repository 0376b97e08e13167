"""PartUV service and its peers, side by side on the same meshes: `make bench`."""
