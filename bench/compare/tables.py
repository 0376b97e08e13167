"""The results as Markdown tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import fmean

from bench.compare.results import Result
from bench.compare.summary import ByMesh, Finished, finished, mean_ratio, sum_ratio

_MARKS = {"failed": "failed", "timeout": "time-out", "unavailable": "not available"}

_COMPARED_HEAD = (
    "tool",
    "finished",
    "charts",
    "charts / ours",
    "seams / ours",
    "roughness",
    "slivers",
    "worst area",
    "angular",
    "all frames",
    "flips",
    "overlaps",
    "least gutter",
    "efficiency",
    "seconds / ours",
    "CPU / ours",
    "peak MB",
)
_STEPS_HEAD = (
    "version",
    "finished",
    "charts",
    "charts / all",
    "seams / all",
    "worst area",
    "angular",
    "all frames",
    "efficiency",
    "seconds / all",
    "CPU / all",
)


def compared_table(tools: Sequence[str], results: Mapping[str, ByMesh], base: str) -> str:
    """A row per tool over the meshes that it finished; ratios to the base on common meshes."""
    ours = finished(results[base])
    rows = []
    for tool in tools:
        runs = finished(results[tool])
        if not runs:
            rows.append([tool, _why_none(results[tool])])
            continue
        gutters = [
            run.figures.gutter_texels
            for run in runs.values()
            if run.figures.gutter_texels is not None
        ]
        rows.append(
            [
                tool,
                f"{len(runs)} of {len(results[tool])}",
                *_ratios(runs, ours),
                *_seams(runs),
                *_quality(runs),
                f"{sum(run.figures.flipped_faces for run in runs.values()):,}",
                f"{sum(run.figures.overlapping_pairs for run in runs.values()):,}",
                f"{min(gutters):.1f}" if gutters else "",
                f"{fmean(run.figures.efficiency for run in runs.values()):.2f}",
                *_times(runs, ours),
                f"{max(run.peak_rss_mb for run in runs.values()):,.0f}",
            ]
        )
    return _table(_COMPARED_HEAD, rows)


def steps_table(versions: Sequence[str], results: Mapping[str, ByMesh], base: str) -> str:
    """A row per version of the engine, relative to the whole engine."""
    whole = finished(results[base])
    rows = []
    for version in versions:
        runs = finished(results[version])
        if not runs:
            rows.append([version, _why_none(results[version])])
            continue
        rows.append(
            [
                version,
                f"{len(runs)} of {len(results[version])}",
                *_ratios(runs, whole),
                *_quality(runs),
                f"{fmean(run.figures.efficiency for run in runs.values()):.2f}",
                *_times(runs, whole),
            ]
        )
    return _table(_STEPS_HEAD, rows)


def meshes_table(tools: Sequence[str], results: Mapping[str, ByMesh]) -> str:
    """Charts and seconds of each tool on each mesh, small meshes first."""
    faces = {r.mesh: r.faces for by_mesh in results.values() for r in by_mesh.values()}
    rows = [
        [mesh, f"{faces[mesh]:,}", *(_cell(results[tool].get(mesh)) for tool in tools)]
        for mesh in sorted(faces, key=lambda name: (faces[name], name))
    ]
    return _table(("mesh", "faces", *tools), rows)


def _ratios(runs: Mapping[str, Finished], others: Mapping[str, Finished]) -> list[str]:
    return [
        f"{sum(run.figures.charts for run in runs.values()):,}",
        _number(mean_ratio(runs, others, lambda run: run.figures.charts)),
        _number(mean_ratio(runs, others, lambda run: run.figures.seam_length)),
    ]


def _seams(runs: Mapping[str, Finished]) -> list[str]:
    """Roughness in the mean and the sum of slivers, of the runs in which they were measured."""
    roughness = [run.figures.seam_roughness for run in runs.values()]
    slivers = [run.figures.slivers for run in runs.values()]
    rough = [value for value in roughness if value is not None]
    thin = [value for value in slivers if value is not None]
    return [f"{fmean(rough):.2f}" if rough else "", f"{sum(thin):,}" if thin else ""]


def _quality(runs: Mapping[str, Finished]) -> list[str]:
    return [
        f"{max(run.figures.area_distortion_worst for run in runs.values()):.3f}",
        f"{fmean(run.figures.angular_mean for run in runs.values()):.3f}",
        f"{fmean(run.figures.angular_all_frames for run in runs.values()):.3f}",
    ]


def _times(runs: Mapping[str, Finished], others: Mapping[str, Finished]) -> list[str]:
    return [
        _number(sum_ratio(runs, others, lambda run: run.seconds)),
        _number(sum_ratio(runs, others, lambda run: run.cpu_seconds)),
    ]


def _cell(result: Result | None) -> str:
    if result is None:
        return ""
    if result.figures is None or result.seconds is None:
        return _MARKS[result.status]
    return f"{result.figures.charts:,} ({result.seconds:.1f} s)"


def _why_none(results: ByMesh) -> str:
    statuses = {result.status for result in results.values()}
    return " and ".join(sorted(_MARKS[status] for status in statuses)) or "not run"


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines: list[Sequence[str]] = [head, ["---", *["---:"] * (len(head) - 1)]]
    lines += [[*row, *[""] * (len(head) - len(row))] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
