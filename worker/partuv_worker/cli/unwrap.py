"""`partuv unwrap`: one GLB or a folder of them, with progress and a summary."""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import threading
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from partuv_contract.errors import (
    CancelledError,
    FeaturesError,
    InputError,
    OptionError,
    PartuvError,
)
from partuv_contract.options import UnwrapOptions
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from partuv_worker.cli.arguments import add_option_flags, options_from
from partuv_worker.cli.files import Job, plan_jobs, write_atomically
from partuv_worker.cli.part_features import add_feature_flags, feature_settings
from partuv_worker.cli.summary import print_summary
from partuv_worker.features import Priors

if TYPE_CHECKING:
    from partuv_worker.pipeline import UnwrapResult

EXIT_DONE, EXIT_FAILED, EXIT_USAGE, EXIT_REFUSED, EXIT_FILES, EXIT_SOME_FAILED = 0, 1, 2, 3, 4, 6
EXIT_CANCELLED = 130
_EXIT_CODES = """\
exit codes: 0 done; 1 failed unexpectedly; 2 wrong arguments or options;
3 the input or the checkpoint was refused;
4 a file could not be read or written; 6 some files of a folder failed; 130 cancelled"""
_POLL_S = 0.1


class _Setting(NamedTuple):
    """What is the same for all files."""

    options: UnwrapOptions
    threads: int
    priors: Priors


def command(arguments: Sequence[str]) -> int:
    """Give a GLB, or every GLB of a folder, a UV atlas."""
    parsed = _parser().parse_args(arguments)
    console = Console(stderr=True, quiet=parsed.quiet)
    if parsed.features is None and parsed.checkpoint is not None:
        parsed.features = "auto"
    priors = Priors(feature_settings(parsed))
    try:
        options = options_from(parsed)
        if options.features == "partfield":
            priors.partfield()  # a bad checkpoint is told before any file is touched
        jobs = plan_jobs(parsed.input, parsed.output, parsed.report, parsed.preview)
    except OptionError as refusal:
        return _complain(console, str(refusal), EXIT_USAGE)
    except FeaturesError as refusal:
        return _complain(console, f"{refusal} [{refusal.code}]", EXIT_REFUSED)
    except OSError as failure:
        return _complain(console, _told(failure), EXIT_FILES)
    setting = _Setting(options, parsed.threads, priors)
    if not parsed.input.is_dir():
        return _unwrap_file(jobs[0], setting, console)
    return _unwrap_folder(jobs, setting, console)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="partuv unwrap",
        description="Write the same GLB with a UV atlas: few charts, along parts, verified.",
        epilog=_EXIT_CODES,
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
    parser.add_argument(
        "--threads",
        type=_at_least_one,
        default=len(os.sched_getaffinity(0)),
        help="how many to use (default: %(default)s)",
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="say nothing unless it fails")
    add_option_flags(parser)
    add_feature_flags(parser)
    return parser


def _at_least_one(text: str) -> int:
    """A number of threads."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return number


def _unwrap_folder(jobs: Sequence[Job], setting: _Setting, console: Console) -> int:
    """Unwrap all files, whatever happens to some of them."""
    if not jobs:
        return _complain(console, "the folder holds no .glb file", EXIT_FILES)
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
        return _complain(console, f"these failed:\n{names}", EXIT_SOME_FAILED)
    return EXIT_DONE


def _unwrap_file(job: Job, setting: _Setting, console: Console) -> int:
    try:
        data = job.source.read_bytes()
        result = _run_with_progress(data, setting, console)
        write_atomically(job.target, result.glb)
        if job.report is not None:
            text = json.dumps(result.report.model_dump(), indent=2) + "\n"
            write_atomically(job.report, text.encode())
        if job.preview is not None:
            write_atomically(job.preview, result.preview_png())
    except CancelledError:
        return _complain(console, "cancelled, nothing was written", EXIT_CANCELLED)
    except InputError as refusal:
        return _complain(console, f"{job.source}: {refusal} [{refusal.code}]", EXIT_REFUSED)
    except OptionError as refusal:
        return _complain(console, str(refusal), EXIT_USAGE)
    except PartuvError as failure:
        return _complain(console, f"{job.source}: {failure}", EXIT_FAILED)
    except OSError as failure:
        return _complain(console, _told(failure), EXIT_FILES)
    print_summary(console, result.report, job.target)
    return EXIT_DONE


def _run_with_progress(data: bytes, setting: _Setting, console: Console) -> UnwrapResult:
    """Run in a thread of its own, so that the bar moves and Ctrl-C is heard."""
    from partuv_worker.pipeline import Unwrap  # the engine is loaded only to work, not for --help

    unwrap = Unwrap(setting.options, threads=setting.threads, priors=setting.priors)
    outcome: list[UnwrapResult | BaseException] = []

    def work() -> None:
        try:
            outcome.append(unwrap.run(data))
        except BaseException as failure:  # handed to the main thread below
            outcome.append(failure)

    worker = threading.Thread(target=work, name="unwrap")
    columns = (BarColumn(), TextColumn("{task.percentage:>3.0f}%"), TimeElapsedColumn())
    bar = Progress(*columns, TextColumn("{task.description}"), console=console, transient=True)
    previous = signal.signal(signal.SIGINT, lambda *_: unwrap.cancel())
    try:
        with bar:
            task = bar.add_task("reading", total=1.0)
            worker.start()
            while worker.is_alive():
                worker.join(_POLL_S)
                fraction, stage = unwrap.progress
                bar.update(task, completed=fraction, description=stage)
    finally:
        signal.signal(signal.SIGINT, previous)
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    return outcome[0]


def _complain(console: Console, message: str, code: int) -> int:
    """Say what went wrong, even if quiet; returns the code."""
    if code == EXIT_FAILED:
        traceback.print_exc()
    print(f"partuv unwrap: {message}", file=sys.stderr)
    return code


def _told(failure: OSError) -> str:
    """What the operating system complained about."""
    return f"{failure.filename or 'file'}: {failure.strerror or failure}"
