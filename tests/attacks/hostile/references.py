"""Files that point outside of themselves, ask too much of readers, or hold nothing."""

from __future__ import annotations

import base64

from partuv_contract.errors import (
    ExternalUriError,
    MalformedGlbError,
    NoTrianglesError,
    UnsupportedError,
)

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import tetrahedron


def with_buffer(uri):
    builder = tetrahedron()
    builder.json["buffers"] = [{"byteLength": len(builder.binary), "uri": uri}]
    return builder.build()


@attack(ExternalUriError)
def local_file():
    """Reads a file of the server."""
    return with_buffer("file:///etc/passwd")


@attack(ExternalUriError)
def relative_path():
    """Climbs out of the working folder."""
    return with_buffer("../../../../etc/passwd")


@attack(ExternalUriError)
def metadata_service():
    """Makes the server ask the address where cloud machines keep their credentials."""
    return with_buffer("http://169.254.169.254/latest/meta-data/")


@attack(ExternalUriError)
def capital_data():
    """A URI that a sloppy check takes for a data URI."""
    return with_buffer("DATA.example.com/data:application/octet-stream;base64,AAAA")


@attack(MalformedGlbError)
def short_data_uri():
    """A data URI that holds less than its buffer claims."""
    text = base64.b64encode(b"short").decode()
    return with_buffer(f"data:application/octet-stream;base64,{text}")


@attack(UnsupportedError)
def unknown_requirement():
    """Requires an extension that may change what every number means."""
    builder = tetrahedron()
    builder.json["extensionsRequired"] = ["ACME_encrypted_geometry"]
    return builder.build()


@attack(NoTrianglesError)
def nothing_to_do():
    """A valid scene without a triangle, to reach the engine with an empty mesh."""
    builder = tetrahedron()
    builder.json["meshes"][0]["primitives"][0]["mode"] = 1
    return builder.build()
