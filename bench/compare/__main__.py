"""PartUV service and its peers on the same meshes, judged alike; and our engine step by step.

    python -m bench.compare [MESHES] [--page docs/benchmarks.md]

MESHES is a folder of GLBs; without it the bench makes a few shapes of its own. Every tool runs in
an environment of its own in the cache. A run that was stopped goes on where it was; what is done is
not done again unless the mesh or the tool has changed. The page tells of all sets in the cache.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from bench.compare.environments import Environments
from bench.compare.measuring import measure_all
from bench.compare.meshes import OWN_SET, meshes_at, own_meshes
from bench.compare.page import write_page
from bench.compare.results import Results
from bench.compare.tools import chosen_tools

DEFAULT_CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "partuv-bench"


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="bench.compare",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("meshes", nargs="?", type=Path, help="folder of GLBs")
    parser.add_argument("--page", type=Path, default=Path("docs/benchmarks.md"))
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    parser.add_argument("--limit-s", type=float, default=120.0, help="per mesh and tool")
    parser.add_argument("--tools", help="a;b;...: names, or what they contain; all without it")
    parsed = parser.parse_args()
    cache: Path = parsed.cache
    if parsed.meshes is None:
        set_name, meshes = OWN_SET, own_meshes(cache / "meshes")
    else:
        set_name, meshes = parsed.meshes.resolve().name, meshes_at(parsed.meshes)
    if not meshes:
        sys.exit(f"no GLB in {parsed.meshes}")
    words = (parsed.tools or "").split(";")
    with tempfile.TemporaryDirectory() as scratch:
        measure_all(
            meshes,
            chosen_tools(words),
            Results(cache / "results" / f"{set_name}.jsonl"),
            Environments(cache / "environments"),
            Path(scratch),
            # Only what is ours is kept, and shown.
            cache / "atlases" if parsed.meshes is None else None,
            parsed.limit_s,
        )
    write_page(parsed.page, cache)
    print(f"wrote {parsed.page}")


if __name__ == "__main__":
    main()
