"""Who takes part, in which version and with which arguments."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

_ADAPTERS = "bench.compare.adapters"
_OUR_PACKAGES = ("partuv_contract", "partuv_engine", "partuv_worker")
_BLENDER = "bpy==5.0.1"


@dataclass(frozen=True)
class Tool:
    """One column: an adapter, what it needs, and what it is told."""

    name: str
    adapter: str
    requirements: tuple[str, ...] = ()  # none: this project, in the environment of the bench
    bare: tuple[str, ...] = ()  # requirements to install without what they depend on
    arguments: tuple[str, ...] = ()

    @property
    def module(self) -> str:
        return f"{_ADAPTERS}.{self.adapter}"

    @property
    def is_ours(self) -> bool:
        return not (self.requirements or self.bare)

    @property
    def packages(self) -> str:
        """What its environment is made of."""
        return our_version() if self.is_ours else " ".join(self.bare + self.requirements)

    @property
    def version(self) -> str:
        """Packages and a digest of how they are used; what is done in it is not done again."""
        source = (Path(__file__).parent / "adapters" / f"{self.adapter}.py").read_bytes()
        recipe = hashlib.sha256(source + "\0".join(self.arguments).encode())
        return f"{self.packages} [{recipe.hexdigest()[:6]}]"


OURS = Tool("PartUV service", "service", arguments=("{}",))

PEERS = (
    Tool(
        "PartUV engine",
        "partuv_tool",
        ("numpy", "scipy", "scikit-learn", _BLENDER),
        bare=("partuv==0.1.2",),
    ),
    Tool("uvunwrap", "uvunwrap_tool", ("numpy", "uvunwrap==0.3.0")),
    Tool("xatlas", "xatlas_tool", ("numpy", "xatlas==0.0.11")),
    Tool("xatlas, scaled", "xatlas_tool", ("numpy", "xatlas==0.0.11"), arguments=("scaled",)),
    Tool("Blender Smart UV", "blender_tool", ("numpy", _BLENDER)),
    Tool("Open3D UVAtlas", "open3d_tool", ("numpy", "open3d==0.20.0", "libusb-package")),
)

COMPARED = (
    OURS,
    Tool("PartUV service, fast", "service", arguments=('{"quality": "fast"}',)),
    Tool("PartUV service, best", "service", arguments=('{"quality": "best"}',)),
    Tool("PartUV service, conformal", "service", arguments=('{"profile": "conformal"}',)),
    *PEERS,
)

_CHANGES: dict[str, dict[str, object]] = {
    "everything": {},
    "tree from normals": {"tree": "normals"},
    "fixed 20 parts": {"ablation": {"fixed_parts": 20}},
    "no Merge": {"ablation": {"merge_heuristic": False}},
    "with recursion": {"ablation": {"recursion": True}},
    "no surrogate": {"ablation": {"proxy": False}},
    "LSCM for ABF++": {"options": {"flattening": "lscm"}},
    "no denoising": {"options": {"denoise": 0.0}},
    "no polish": {"ablation": {"polish": False}},
    "no cutting open": {"ablation": {"cut_open": False}},
    "no final merge": {"ablation": {"final_merge": False}},
}

ABLATIONS = tuple(
    Tool(name, "ablation", arguments=(json.dumps(change),)) for name, change in _CHANGES.items()
)


def chosen_tools(words: Sequence[str]) -> list[Tool]:
    """Tools of that name, or whose names contain the word where no tool has it as its name."""
    every = (*COMPARED, *ABLATIONS)
    names = {tool.name for tool in every}
    return [
        tool
        for tool in every
        if any(word == tool.name or (word not in names and word in tool.name) for word in words)
    ]


@cache
def our_version() -> str:
    """The release and a digest of the installed code, so that a rebuilt engine is measured anew."""
    digest = hashlib.sha256()
    for name in _OUR_PACKAGES:
        spec = find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        folder = Path(spec.origin).parent
        for path in sorted(folder.rglob("*")):
            if path.suffix in {".py", ".so", ".pyd"}:
                digest.update(path.read_bytes())
    return f"partuv-service {version('partuv-service')} {digest.hexdigest()[:8]}"
