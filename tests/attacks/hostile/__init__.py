"""Hostile GLB files, one per line of defence, each with a sentence on what it tries."""

from tests.attacks.hostile import accessors, compressed, container, graph, json_text, references
from tests.attacks.hostile.catalogue import ATTACKS

__all__ = ["ATTACKS", "accessors", "compressed", "container", "graph", "json_text", "references"]
