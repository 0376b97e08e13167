"""The table at the end of an unwrap."""

from __future__ import annotations

from pathlib import Path

from partuv_contract.report import UnwrapReport
from rich.console import Console
from rich.table import Table


def print_summary(console: Console, report: UnwrapReport, target: Path) -> None:
    """Print the figures a person judges the atlas by."""
    table = Table(show_header=False, box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column()
    table.add_column(overflow="fold")
    table.add_row("triangles", f"{report.faces:,}")
    table.add_row("charts", f"{report.chart_count:,}, on {report.part_count:,} parts of the model")
    table.add_row(
        "area distortion",
        f"{report.area_distortion_mean:.3f} mean, {report.area_distortion_worst:.3f} worst chart",
    )
    table.add_row("angular score", f"{report.angular_mean:.3f} mean")
    table.add_row("seam length", f"{report.seam_length:.2f} x square root of the area")
    table.add_row("packing", f"{report.packing_efficiency:.1%} of the square")
    spent = "  ".join(f"{stage} {seconds:.2f}" for stage, seconds in report.seconds.items())
    table.add_row("seconds", f"{sum(report.seconds.values()):.2f}  ({spent})")
    features = report.features
    if features is not None:
        version = f" {features.version[:19]}" if features.prior == "partfield" else ""
        table.add_row("part tree", f"{features.prior}{version}")
    for note in report.notes:
        table.add_row("note", note)
    table.add_row("written", f"{target} ({report.output_bytes:,} bytes)")
    console.print(table)
