"""Graphs of nodes without an end."""

from __future__ import annotations

from partuv_contract.errors import LimitError, MalformedGlbError

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import tetrahedron


@attack(MalformedGlbError)
def circle_of_nodes():
    """Nodes that are their own ancestors, to make a walk endless."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [2]}, {"children": [1]}]
    return builder.build()


@attack(MalformedGlbError)
def exponential_graph():
    """Forty levels that each name the next one twice: 2^40 instances."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [k + 2, k + 2]} for k in range(40)] + [{"mesh": 0}]
    return builder.build()


@attack(LimitError)
def endless_chain():
    """Twenty thousand nodes in one line, to exhaust a recursive walk."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [k + 2]} for k in range(20_000)] + [{"mesh": 0}]
    builder.json["scenes"][0]["nodes"].append(1)
    return builder.build()


@attack(MalformedGlbError)
def transform_to_infinity():
    """Finite numbers that multiply to infinity on the way down the graph."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [2], "scale": [1e200] * 3}, {"scale": [1e200] * 3}]
    builder.json["nodes"][2]["mesh"] = 0
    builder.json["scenes"][0]["nodes"] = [1]
    return builder.build()
