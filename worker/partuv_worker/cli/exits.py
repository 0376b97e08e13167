"""Exit codes and complaints, the same for every command that works on GLBs."""

from __future__ import annotations

import sys
import traceback

from partuv_contract.errors import (
    CancelledError,
    ComponentMissingError,
    FeaturesError,
    InputError,
    OptionError,
)
from partuv_contract.service_errors import JobError, ServiceError

EXIT_DONE, EXIT_FAILED, EXIT_USAGE, EXIT_REFUSED, EXIT_FILES, EXIT_SOME_FAILED = 0, 1, 2, 3, 4, 6
EXIT_COMPONENT_MISSING, EXIT_SERVICE, EXIT_CANCELLED = 5, 7, 130
EXIT_CODES = """\
exit codes: 0 done; 1 failed unexpectedly; 2 wrong arguments or options;
3 the input or the checkpoint was refused;
4 a file could not be read or written; 5 a component is not installed;
6 some files of a folder failed; 7 the service could not do it; 130 cancelled"""


def complain(command: str, message: str, code: int) -> int:
    """Say what went wrong, even if quiet; returns the code."""
    if code == EXIT_FAILED:
        traceback.print_exc()
    print(f"partuv {command}: {message}", file=sys.stderr)
    return code


def code_and_message(failure: Exception, source: object) -> tuple[int, str]:
    """What to tell about a file that could not be done."""
    if isinstance(failure, CancelledError):
        return EXIT_CANCELLED, "cancelled, nothing was written"
    if isinstance(failure, OptionError):
        return EXIT_USAGE, str(failure)
    if isinstance(failure, OSError):
        return EXIT_FILES, f"{failure.filename or 'file'}: {failure.strerror or failure}"
    if isinstance(failure, FeaturesError):
        return EXIT_REFUSED, f"{failure} [{failure.code}]"
    if isinstance(failure, InputError):
        return EXIT_REFUSED, f"{source}: {failure} [{failure.code}]"
    if isinstance(failure, ComponentMissingError):
        return EXIT_COMPONENT_MISSING, str(failure)
    if isinstance(failure, (ServiceError, JobError)):
        return EXIT_SERVICE, f"{source}: {failure} [{failure.code}]"
    return EXIT_FAILED, f"{source}: {failure}"
