"""UV unwrapping: a triangle mesh in, a verified atlas out."""

from ._core import (
    Atlas,
    Context,
    Flattener,
    Options,
    PartTree,
    Profile,
    Proxy,
    Surface,
    build_nbm_tree,
    build_part_tree,
    build_ward_tree,
    cut_tree,
    cut_tree_auto,
    flatten,
    import_tree,
    read_tree_file,
    unwrap,
)
from ._errors import EngineError

__all__ = [
    "Atlas",
    "Context",
    "EngineError",
    "Flattener",
    "Options",
    "PartTree",
    "Profile",
    "Proxy",
    "Surface",
    "build_nbm_tree",
    "build_part_tree",
    "build_ward_tree",
    "cut_tree",
    "cut_tree_auto",
    "flatten",
    "import_tree",
    "read_tree_file",
    "unwrap",
]
