"""Why a request or a job of the service failed; continues the tree of `partuv_contract.errors`.

PartuvError
├── ServiceError                     the service says no
│   ├── RequestError
│   │   ├── MalformedRequestError    malformed_request: can't be read as a request
│   │   ├── InvalidParameterError    invalid_parameter: a parameter or header is out of its range
│   │   ├── MediaTypeError           unsupported_media_type: neither a GLB nor a form
│   │   ├── UploadTooLargeError      upload_too_large: more bytes than allowed
│   │   ├── WebhookRefusedError      webhook_refused: an address webhooks don't go to
│   │   ├── IdempotencyError         idempotency_key_reused: same key, another request
│   │   └── RangeError               range_not_satisfiable: past the end of the result
│   ├── UnauthorizedError            unauthorized: no key, or an unknown one
│   ├── NotFoundError                not_found: no such address
│   │   └── JobNotFoundError         job_not_found: no such job, or another key's
│   ├── MethodNotAllowedError        method_not_allowed
│   ├── NoResultError                no_result: the job ended without one
│   │   └── ResultNotReadyError      result_not_ready: the job is still going
│   ├── RateLimitedError             rate_limited: too many requests per minute
│   │   └── TooManyJobsError         too_many_jobs: too many unfinished jobs of one key
│   └── UnavailableError             unavailable: the service can't answer now
│       ├── QueueFullError           queue_full: too many jobs wait
│       ├── StoreFullError           store_full: no room for another upload
│       └── StoreUnavailableError    store_unavailable: Redis is away
└── JobError                         what befell an accepted job
    ├── WorkerLostError              worker_lost: its worker died, more than once
    ├── OutOfMemoryError             out_of_memory: needs more than a job may have
    ├── TimeLimitError               time_limit_exceeded: ran longer than a job may
    └── QueueTimeoutError            queue_timeout: no worker took it in time
"""

from __future__ import annotations

from partuv_contract.errors import PartuvError


class ServiceError(PartuvError):
    """The service could not do what was asked; `retry_after_s` says when to ask again."""

    retry_after_s: float | None = None

    def __init__(
        self,
        message: str,
        *,
        pointer: str | None = None,
        byte_offset: int | None = None,
        retry_after_s: float | None = None,
    ) -> None:
        super().__init__(message, pointer=pointer, byte_offset=byte_offset)
        if retry_after_s is not None:
            self.retry_after_s = retry_after_s


class RequestError(ServiceError):
    """The request is at fault."""

    code = "bad_request"
    http_status = 400
    grpc_status = "INVALID_ARGUMENT"


class MalformedRequestError(RequestError):
    """The request can't be read."""

    code = "malformed_request"


class InvalidParameterError(RequestError):
    """A parameter or header is out of its range."""

    code = "invalid_parameter"
    http_status = 422


class MediaTypeError(RequestError):
    """The body is neither model/gltf-binary nor multipart/form-data."""

    code = "unsupported_media_type"
    http_status = 415


class UploadTooLargeError(RequestError):
    """The upload has more bytes than this service takes."""

    code = "upload_too_large"
    http_status = 413
    grpc_status = "RESOURCE_EXHAUSTED"


class WebhookRefusedError(RequestError):
    """Webhooks are not sent to this address."""

    code = "webhook_refused"
    http_status = 422


class IdempotencyError(RequestError):
    """This idempotency key belongs to another request."""

    code = "idempotency_key_reused"
    http_status = 422


class RangeError(RequestError):
    """The range lies outside the result."""

    code = "range_not_satisfiable"
    http_status = 416
    grpc_status = "OUT_OF_RANGE"


class UnauthorizedError(ServiceError):
    """A valid API key is needed."""

    code = "unauthorized"
    http_status = 401
    grpc_status = "UNAUTHENTICATED"


class NotFoundError(ServiceError):
    """There is nothing at this address."""

    code = "not_found"
    http_status = 404
    grpc_status = "NOT_FOUND"


class JobNotFoundError(NotFoundError):
    """There is no such job, or no longer."""

    code = "job_not_found"


class MethodNotAllowedError(ServiceError):
    """This address knows other methods."""

    code = "method_not_allowed"
    http_status = 405
    grpc_status = "UNIMPLEMENTED"


class NoResultError(ServiceError):
    """The job ended without a result."""

    code = "no_result"
    http_status = 409
    grpc_status = "FAILED_PRECONDITION"


class ResultNotReadyError(NoResultError):
    """The job has not ended yet."""

    code = "result_not_ready"
    retry_after_s = 1


class RateLimitedError(ServiceError):
    """Too many requests with this key."""

    code = "rate_limited"
    http_status = 429
    grpc_status = "RESOURCE_EXHAUSTED"
    retry_after_s = 1


class TooManyJobsError(RateLimitedError):
    """Too many unfinished jobs with this key."""

    code = "too_many_jobs"
    retry_after_s = 5


class UnavailableError(ServiceError):
    """The service can't answer now."""

    code = "unavailable"
    http_status = 503
    grpc_status = "UNAVAILABLE"
    retry_after_s = 5


class QueueFullError(UnavailableError):
    """Too many jobs are waiting."""

    code = "queue_full"


class StoreFullError(UnavailableError):
    """There is no room for another upload."""

    code = "store_full"
    retry_after_s = 60


class StoreUnavailableError(UnavailableError):
    """The job store does not answer."""

    code = "store_unavailable"
    retry_after_s = 2


class JobError(PartuvError):
    """What befell an accepted job."""


class WorkerLostError(JobError):
    """The worker died with this job, and again when it was tried once more."""

    code = "worker_lost"


class OutOfMemoryError(JobError):
    """The job needs more memory than a job may have."""

    code = "out_of_memory"
    http_status = 422
    grpc_status = "RESOURCE_EXHAUSTED"


class TimeLimitError(JobError):
    """The job ran longer than a job may."""

    code = "time_limit_exceeded"
    http_status = 504
    grpc_status = "DEADLINE_EXCEEDED"


class QueueTimeoutError(JobError):
    """No worker took the job before it expired."""

    code = "queue_timeout"
    http_status = 504
    grpc_status = "DEADLINE_EXCEEDED"
