"""The reader and writer on real assets; the figures of the manifests are the reference."""

import csv
from pathlib import Path

import numpy as np
import pytest
from partuv_contract.errors import InputError
from partuv_worker.glb.scene import Scene

from tests.support.uv import separate_faces

CORPORA = Path(__file__).parents[4] / "shared" / "meshes"


def rows(folder):
    if not CORPORA.is_dir():
        return []
    with open(CORPORA / folder / "MANIFEST.csv", newline="") as stream:
        return [pytest.param(row, id=row["file"]) for row in csv.DictReader(stream)]


def corpus(*folders):
    found = [
        (CORPORA / folder / row.values[0]["file"], row)
        for folder in folders
        for row in rows(folder)
    ]
    absent = pytest.param(None, None, marks=pytest.mark.skip(reason="no mesh corpora at hand"))
    return [pytest.param(path, row.values[0], id=row.id) for path, row in found] or [absent]


def round_trip(path):
    """Write UVs into a file and read it again; returns both scenes."""
    before = Scene(path.read_bytes())
    written = before.write(separate_faces(len(before.soup.faces)))
    return before, Scene(written)


def world_triangles(scene):
    return scene.soup.positions[scene.soup.faces]


@pytest.mark.parametrize(("path", "row"), corpus("malformed"))
def test_malformed_files_behave_as_their_manifest_says(path, row):
    if row["expect"] == "reject":
        with pytest.raises(InputError) as caught:
            round_trip(path)
        assert caught.value.message
        return
    try:
        before, after = round_trip(path)
    except InputError:
        assert row["expect"] == "either"
        return
    assert np.array_equal(world_triangles(before), world_triangles(after))


@pytest.mark.parametrize(("path", "row"), corpus("cad", "common", "generated", "manmade", "nasty"))
def test_every_triangle_of_an_asset_comes_back(path, row):
    expected = row.get("expect", "accept")
    if row["faces"] == "0":
        expected = "reject"
    try:
        before, after = round_trip(path)
    except InputError:
        assert expected in ("reject", "repair")
        return
    assert np.array_equal(world_triangles(before), world_triangles(after))
    if "instancing" not in row["notes"]:
        assert len(before.soup.faces) == int(row["faces"])
