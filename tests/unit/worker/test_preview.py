import io

import numpy as np
from partuv_worker.preview import draw_atlas
from PIL import Image

SQUARES = np.array(
    [
        [[0.1, 0.1], [0.4, 0.1], [0.4, 0.4]],
        [[0.1, 0.1], [0.4, 0.4], [0.1, 0.4]],
        [[0.6, 0.6], [0.9, 0.6], [0.9, 0.9]],
        [[0.6, 0.6], [0.9, 0.9], [0.6, 0.9]],
    ],
    np.float32,
)
CHART = np.array([0, 0, 1, 1], np.int32)


def draw(part, tile=(0, 0, 0, 0)):
    png = draw_atlas(SQUARES, CHART, np.array(part, np.int32), np.array(tile, np.int32), 128)
    return np.asarray(Image.open(io.BytesIO(png)))


def at(picture, u, v):
    return tuple(int(x) for x in picture[round((1 - v) * 127), round(u * 127)])


def test_charts_stand_where_their_uvs_are_with_v_up():
    picture = draw([0, 0, 1, 1])
    background = at(picture, 0.25, 0.75)
    assert at(picture, 0.3, 0.2) != background
    assert at(picture, 0.8, 0.7) != background
    assert at(picture, 0.75, 0.25) == background


def test_parts_differ_in_colour():
    picture = draw([0, 0, 1, 1])
    first, second = (np.array(at(picture, *uv)) for uv in ((0.3, 0.2), (0.8, 0.7)))
    assert np.abs(first - second).max() > 60
    assert at(picture, 0.3, 0.2) == at(picture, 0.2, 0.3)


def test_tiles_lie_side_by_side():
    picture = draw([0, 0, 1, 1], (0, 0, 1, 1))
    assert picture.shape == (128, 256, 3)
    right = picture[:, 128:]
    assert at(right, 0.8, 0.7) != at(right, 0.3, 0.2)


def test_the_same_atlas_gives_the_same_bytes():
    arguments = (SQUARES, CHART, CHART, np.zeros(4, np.int32), 64)
    assert draw_atlas(*arguments) == draw_atlas(*arguments)


def test_a_chart_shows_all_its_parts():
    picture = draw([0, 1, 1, 1])
    first, second = (np.array(at(picture, *uv)) for uv in ((0.3, 0.2), (0.2, 0.3)))
    assert np.abs(first - second).max() > 60
