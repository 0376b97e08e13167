"""`partuv parts`: the parts of a GLB, without an unwrap."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from partuv_contract.errors import PartuvError
from partuv_contract.report import SegmentReport
from rich.console import Console
from rich.table import Table

from partuv_worker.cli.arguments import add_option_flags, add_running_flags, options_from
from partuv_worker.cli.exits import EXIT_CODES, EXIT_DONE, EXIT_USAGE, code_and_message, complain
from partuv_worker.cli.files import write_atomically
from partuv_worker.cli.part_features import add_feature_flags, feature_settings
from partuv_worker.cli.running import run_with_progress
from partuv_worker.features import Priors


def command(arguments: Sequence[str]) -> int:
    """Tell the parts of a GLB that people would name, or a number of them."""
    parsed = _parser().parse_args(arguments)
    console = Console(stderr=True, quiet=parsed.quiet)
    if parsed.parts == "search":
        return complain("parts", "the parts of the search come with an unwrap", EXIT_USAGE)
    try:
        options = options_from(parsed)
        from partuv_worker.parts.segment import Segment  # the engine is not loaded for --help

        segment = Segment(
            "auto" if options.parts == "search" else options.parts,
            features=options.features,
            only=options.only,
            threads=parsed.threads,
            priors=Priors(feature_settings(parsed)),
        )
        result = run_with_progress(segment, parsed.input.read_bytes(), console)
        if parsed.output is not None:
            write_atomically(parsed.output, result.parts_glb())
    except (PartuvError, OSError) as failure:
        code, message = code_and_message(failure, parsed.input)
        return complain("parts", message, code)
    if parsed.json:
        per_face = {"part_of_face": result.part.tolist()}
        json.dump(result.report.model_dump() | per_face, sys.stdout)
        print()
    _print_table(console, result.report, parsed.output)
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="partuv parts", description=command.__doc__, epilog=EXIT_CODES
    )
    parser.add_argument("input", type=Path, help="a GLB file")
    parser.add_argument("-o", "--output", type=Path, help="write the surface coloured by part")
    parser.add_argument(
        "--json", action="store_true", help="print the report and the part of every triangle"
    )
    add_running_flags(parser)
    parser.add_argument(
        "--parts", metavar="auto|NUMBER", help="how many; auto: as many as people would name"
    )
    add_option_flags(parser, ("only", "features"))
    add_feature_flags(parser)
    return parser


def _print_table(console: Console, report: SegmentReport, output: Path | None) -> None:
    table = Table(box=None, pad_edge=False)
    for heading in ("part", "triangles", "area"):
        table.add_column(heading, justify="right")
    for part in report.parts:
        table.add_row(str(part.id), f"{part.faces:,}", f"{part.area_share:.1%}")
    console.print(table)
    console.print(
        f"{report.part_count} parts of {report.faces:,} triangles, "
        f"part tree {report.features.prior}, {report.seconds:.2f} seconds"
    )
    for note in report.notes:
        console.print(f"note: {note}")
    if output is not None:
        console.print(f"written: {output}")
