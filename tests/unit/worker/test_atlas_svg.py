import xml.etree.ElementTree as ElementTree

import numpy as np
from partuv_worker.atlas_svg import draw_atlas_svg

RING = np.array([[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]])
HOLE = RING * 0.5 + 0.25


def ring_with_hole():
    """Eight triangles around a square hole, and a triangle beside them in another tile."""
    triangles = []
    for here, there in ((0, 1), (1, 2), (2, 3), (3, 0)):
        triangles.append([RING[here], RING[there], HOLE[there]])
        triangles.append([RING[here], HOLE[there], HOLE[here]])
    triangles.append([[0.1, 0.1], [0.3, 0.1], [0.1, 0.3]])
    uv = np.array(triangles, np.float32)
    chart = np.array([0] * 8 + [1], np.int32)
    return uv, chart, np.array([4] * 8 + [7], np.int32), chart


def paths(part=None):
    uv, chart, usual, tile = ring_with_hole()
    part = usual if part is None else np.array(part, np.int32)
    root = ElementTree.fromstring(draw_atlas_svg(uv, chart, part, tile, size_texels=100))
    return root, root.findall("{http://www.w3.org/2000/svg}path")


def test_each_chart_is_one_path_with_its_names():
    root, found = paths()
    assert root.get("viewBox") == "0 0 200 100"
    assert [path.get("data-chart") for path in found] == ["0", "1"]
    assert [path.get("data-part") for path in found] == ["4", "7"]
    assert found[0].get("fill") != found[1].get("fill")


def test_holes_are_loops_of_their_own_and_v_points_up():
    _, (ring, triangle) = paths()
    loops = [loop.split("L") for loop in ring.get("d").strip("MZ").split("ZM")]
    assert sorted(len(loop) for loop in loops) == [4, 4]
    corners = {tuple(map(float, corner.split(","))) for loop in loops for corner in loop}
    assert {(20.0, 80.0), (80.0, 20.0), (35.0, 65.0)} <= corners
    assert "110,90" in triangle.get("d"), "the second tile lies to the right"


def test_a_chart_of_two_parts_is_filled_in_both_colours_and_outlined_once():
    _, found = paths([1, 1, 1, 1, 2, 2, 2, 2, 2])
    named = [(path.get("data-chart"), path.get("data-part"), path.get("stroke")) for path in found]
    assert named == [
        ("0", "1", None),
        ("0", "2", None),
        ("1", "2", "#fff"),
        ("0", None, "#fff"),
    ]
    assert found[0].get("fill") != found[1].get("fill")
    assert found[3].get("fill") == "none"
    assert found[3].get("d").count("M") == 2, "its border and its hole, not the parts' border"
