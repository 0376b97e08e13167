import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nst
from partuv_worker.glb.split import split_vertices


def test_without_a_seam_nothing_is_split():
    corners = np.array([0, 1, 2, 2, 1, 3])
    uv = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], np.float32)
    split = split_vertices(corners, uv[corners], 5)
    assert len(split.sources) == 0
    assert (split.corners == corners).all()
    assert (split.vertex_uv[:4] == uv).all()


def test_the_first_corner_keeps_the_number_of_the_vertex():
    corners = np.array([7, 7, 7, 3])
    uv = np.array([[0.5, 0], [0.25, 0], [0.5, 0], [1, 1]], np.float32)
    split = split_vertices(corners, uv, 8)
    assert split.corners.tolist() == [7, 8, 7, 3]
    assert split.sources.tolist() == [7]


@given(st.data())
def test_every_corner_finds_its_vertex_and_uv_with_the_fewest_copies(data):
    count = data.draw(st.integers(1, 8))
    corners = data.draw(
        nst.arrays(np.int64, st.integers(1, 40), elements=st.integers(0, count - 1))
    )
    choices = np.array([0.0, -0.0, 0.25, 1.0], np.float32)
    picks = data.draw(nst.arrays(np.int64, (len(corners), 2), elements=st.integers(0, 3)))
    uv = choices[picks]
    split = split_vertices(corners, uv, count)
    origin = np.concatenate([np.arange(count), split.sources])
    assert (origin[split.corners] == corners).all()
    assert (split.vertex_uv[split.corners] == uv).all()
    wanted = {(c, *map(float, p)) for c, p in zip(corners, uv + 0, strict=True)}
    assert len(split.sources) == len(wanted) - len(set(corners))
