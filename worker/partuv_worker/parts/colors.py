"""One hue per part, the same in every picture and file."""

from __future__ import annotations

import colorsys

Color = tuple[int, int, int]

_GOLDEN_RATIO = 0.6180339887498949  # turns of the hue circle that never come close to each other


def part_color(part: int, rank: int = 0) -> Color:
    """sRGB colour of a part; the charts of a part, told by rank, differ a little in lightness."""
    hue = (0.58 + part * _GOLDEN_RATIO) % 1.0
    lightness = 0.52 + 0.07 * (rank * 2 % 5 - 2) / 2
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, 0.5)
    return round(red * 255), round(green * 255), round(blue * 255)
