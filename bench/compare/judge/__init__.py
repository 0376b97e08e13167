"""One judge for all tools: what an atlas is worth, from its triangles alone."""

from bench.compare.judge.figures import Figures, judge

__all__ = ["Figures", "judge"]
