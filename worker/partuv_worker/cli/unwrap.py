"""`partuv unwrap`: one GLB or a folder of them, with progress and a summary."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from partuv_contract.errors import FeaturesError, OptionError, PartuvError
from partuv_contract.options import UnwrapOptions
from rich.console import Console

from partuv_worker.cli.arguments import add_option_flags, add_running_flags, options_from
from partuv_worker.cli.exits import (
    EXIT_CANCELLED,
    EXIT_CODES,
    EXIT_DONE,
    EXIT_FILES,
    EXIT_SOME_FAILED,
    EXIT_USAGE,
    code_and_message,
    complain,
)
from partuv_worker.cli.files import Job, plan_jobs, write_atomically
from partuv_worker.cli.part_features import add_feature_flags, feature_settings
from partuv_worker.cli.remote import API_KEY, RemoteResult, RemoteUnwrap
from partuv_worker.cli.running import run_with_progress
from partuv_worker.cli.summary import print_summary
from partuv_worker.features import Priors

if TYPE_CHECKING:
    from partuv_worker.pipeline import UnwrapResult


class _Setting(NamedTuple):
    """What is the same for all files."""

    options: UnwrapOptions
    threads: int
    priors: Priors
    server: str | None


def command(arguments: Sequence[str]) -> int:
    """Give a GLB, or every GLB of a folder, a UV atlas."""
    parsed = _parser().parse_args(arguments)
    console = Console(stderr=True, quiet=parsed.quiet)
    priors = Priors(feature_settings(parsed))
    coloured: Path | None = parsed.parts_file
    if coloured is not None and coloured.suffix != ".glb" and not parsed.input.is_dir():
        told = f"--parts takes search, auto, a number or a .glb file to write, not {coloured}"
        return complain("unwrap", told, EXIT_USAGE)
    try:
        options = options_from(parsed)
        if options.features == "partfield" and parsed.server is None:
            priors.partfield()  # a bad checkpoint is told before any file is touched
        jobs = plan_jobs(parsed.input, parsed.output, parsed.report, parsed.preview, coloured)
    except (OptionError, FeaturesError, OSError) as failure:
        code, message = code_and_message(failure, parsed.input)
        return complain("unwrap", message, code)
    if parsed.server is not None and coloured is not None and options.parts == "search":
        told = "a service colours parts that are asked for: add --parts auto or a number"
        return complain("unwrap", told, EXIT_USAGE)
    setting = _Setting(options, parsed.threads, priors, parsed.server)
    if not parsed.input.is_dir():
        return _unwrap_file(jobs[0], setting, console)
    return _unwrap_folder(jobs, setting, console)


class _PartsFlag(argparse.Action):
    """`--parts` says which parts are meant, or names the file that shows them."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        if values in ("search", "auto") or values.lstrip("+-").isdigit():
            namespace.parts = values
        else:
            namespace.parts_file = Path(values)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="partuv unwrap",
        description="Write the same GLB with a UV atlas: few charts, along parts, verified.",
        epilog=EXIT_CODES,
    )
    parser.add_argument("input", type=Path, help="a GLB file, or a folder that holds some")
    parser.add_argument(
        "-o", "--output", type=Path, required=True, help="the GLB to write; a folder for a folder"
    )
    parser.add_argument(
        "--report", type=Path, help="write the figures as JSON; a folder for a folder"
    )
    parser.add_argument(
        "--preview", type=Path, help="write a picture of the atlas (PNG); a folder for a folder"
    )
    add_running_flags(parser)
    parser.add_argument(
        "--server",
        metavar="URL",
        help=f"let a service do it; an API key is taken from the environment's {API_KEY}",
    )
    meaning = UnwrapOptions.model_fields["parts"].description
    parser.add_argument(
        "--parts",
        action=_PartsFlag,
        metavar="search|auto|NUMBER|FILE.glb",
        help=f"{meaning} (default: search). With the name of a file: write the surface coloured "
        "by part; a folder for a folder. May be given twice",
    )
    parser.set_defaults(parts_file=None)
    add_option_flags(parser, UnwrapOptions.model_fields.keys() - {"parts"})
    add_feature_flags(parser)
    return parser


def _unwrap_folder(jobs: Sequence[Job], setting: _Setting, console: Console) -> int:
    """Unwrap all files, whatever happens to some of them."""
    if not jobs:
        return complain("unwrap", "the folder holds no .glb file", EXIT_FILES)
    failed = []
    for number, job in enumerate(jobs, 1):
        console.rule(f"{number}/{len(jobs)}  {job.source.name}", align="left")
        code = _unwrap_file(job, setting, console)
        if code == EXIT_CANCELLED:
            return code
        if code:
            failed.append(job.source)
    console.print(f"{len(jobs) - len(failed)} of {len(jobs)} files unwrapped")
    if failed:
        names = "\n".join(f"  {path}" for path in failed)
        return complain("unwrap", f"these failed:\n{names}", EXIT_SOME_FAILED)
    return EXIT_DONE


def _unwrap_file(job: Job, setting: _Setting, console: Console) -> int:
    try:
        data = job.source.read_bytes()
        result = _run(data, setting, console)
        write_atomically(job.target, result.glb)
        if job.report is not None:
            text = json.dumps(result.report.model_dump(), indent=2) + "\n"
            write_atomically(job.report, text.encode())
        if job.preview is not None:
            write_atomically(job.preview, result.preview_png())
        if job.parts is not None:
            write_atomically(job.parts, result.parts_glb())
    except (PartuvError, OSError) as failure:
        code, message = code_and_message(failure, job.source)
        return complain("unwrap", message, code)
    print_summary(console, result.report, job.target)
    return EXIT_DONE


def _run(data: bytes, setting: _Setting, console: Console) -> UnwrapResult | RemoteResult:
    """Here, or by a service."""
    if setting.server is not None:
        return run_with_progress(RemoteUnwrap(setting.server, setting.options), data, console)
    from partuv_worker.pipeline import Unwrap  # the engine is loaded only to work, not for --help

    unwrap = Unwrap(setting.options, threads=setting.threads, priors=setting.priors)
    return run_with_progress(unwrap, data, console)
