"""Talk to a PartUV service: `PartUV(url).unwrap("in.glb").save("out.glb")`."""

from partuv_client.client import AsyncPartUV, PartUV
from partuv_client.errors import (
    ClientError,
    JobCanceledError,
    JobFailedError,
    ProblemError,
    ServiceUnreachableError,
)
from partuv_client.flows import Unwrapped

__all__ = [
    "AsyncPartUV",
    "ClientError",
    "JobCanceledError",
    "JobFailedError",
    "PartUV",
    "ProblemError",
    "ServiceUnreachableError",
    "Unwrapped",
]
