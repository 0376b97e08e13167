"""What can go wrong on the way to an unwrapped mesh.

ClientError
├── ServiceUnreachableError    nobody answers at the address
├── ProblemError               the service says no; `problem` says why
│   └── JobFailedError         the job was accepted, and failed
└── JobCanceledError           somebody canceled the job
"""

from __future__ import annotations

from partuv_contract.jobs import Job
from partuv_contract.problem import Problem


class ClientError(Exception):
    """Base of the client's errors."""


class ServiceUnreachableError(ClientError):
    """Nobody answers, or what answers is not a PartUV service."""


class ProblemError(ClientError):
    """The service refused; branch on `problem.code`."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(f"{problem.detail} [{problem.code}]")
        self.problem = problem


class JobFailedError(ProblemError):
    """The job failed."""

    def __init__(self, problem: Problem, job: Job) -> None:
        super().__init__(problem)
        self.job = job


class JobCanceledError(ClientError):
    """The job was canceled before it had a result."""

    def __init__(self, job: Job) -> None:
        super().__init__(f"{job.id} was canceled")
        self.job = job
