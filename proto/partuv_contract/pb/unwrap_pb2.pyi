import datetime

from google.protobuf import struct_pb2 as _struct_pb2
from google.protobuf import timestamp_pb2 as _timestamp_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class JobStatus(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    JOB_STATUS_UNSPECIFIED: _ClassVar[JobStatus]
    JOB_STATUS_QUEUED: _ClassVar[JobStatus]
    JOB_STATUS_RUNNING: _ClassVar[JobStatus]
    JOB_STATUS_SUCCEEDED: _ClassVar[JobStatus]
    JOB_STATUS_FAILED: _ClassVar[JobStatus]
    JOB_STATUS_CANCELED: _ClassVar[JobStatus]
JOB_STATUS_UNSPECIFIED: JobStatus
JOB_STATUS_QUEUED: JobStatus
JOB_STATUS_RUNNING: JobStatus
JOB_STATUS_SUCCEEDED: JobStatus
JOB_STATUS_FAILED: JobStatus
JOB_STATUS_CANCELED: JobStatus

class SubmitUnwrapRequest(_message.Message):
    __slots__ = ("request", "chunk")
    REQUEST_FIELD_NUMBER: _ClassVar[int]
    CHUNK_FIELD_NUMBER: _ClassVar[int]
    request: UnwrapRequest
    chunk: bytes
    def __init__(self, request: _Optional[_Union[UnwrapRequest, _Mapping]] = ..., chunk: _Optional[bytes] = ...) -> None: ...

class UnwrapRequest(_message.Message):
    __slots__ = ("options", "webhook_url", "retention_s", "idempotency_key")
    OPTIONS_FIELD_NUMBER: _ClassVar[int]
    WEBHOOK_URL_FIELD_NUMBER: _ClassVar[int]
    RETENTION_S_FIELD_NUMBER: _ClassVar[int]
    IDEMPOTENCY_KEY_FIELD_NUMBER: _ClassVar[int]
    options: UnwrapOptions
    webhook_url: str
    retention_s: int
    idempotency_key: str
    def __init__(self, options: _Optional[_Union[UnwrapOptions, _Mapping]] = ..., webhook_url: _Optional[str] = ..., retention_s: _Optional[int] = ..., idempotency_key: _Optional[str] = ...) -> None: ...

class UnwrapOptions(_message.Message):
    __slots__ = ("max_area_distortion", "min_angular", "profile", "flattening", "denoise", "resolution", "gutter_texels", "deadline_s", "existing_uv", "scope", "only", "compress", "features", "parts", "border_texels", "mip_levels", "snap_to_texels", "rotations", "texel_density", "group_by_part", "tiles", "mode", "repack_scale", "texel_weights", "quality", "cut_below_efficiency")
    MAX_AREA_DISTORTION_FIELD_NUMBER: _ClassVar[int]
    MIN_ANGULAR_FIELD_NUMBER: _ClassVar[int]
    PROFILE_FIELD_NUMBER: _ClassVar[int]
    FLATTENING_FIELD_NUMBER: _ClassVar[int]
    DENOISE_FIELD_NUMBER: _ClassVar[int]
    RESOLUTION_FIELD_NUMBER: _ClassVar[int]
    GUTTER_TEXELS_FIELD_NUMBER: _ClassVar[int]
    DEADLINE_S_FIELD_NUMBER: _ClassVar[int]
    EXISTING_UV_FIELD_NUMBER: _ClassVar[int]
    SCOPE_FIELD_NUMBER: _ClassVar[int]
    ONLY_FIELD_NUMBER: _ClassVar[int]
    COMPRESS_FIELD_NUMBER: _ClassVar[int]
    FEATURES_FIELD_NUMBER: _ClassVar[int]
    PARTS_FIELD_NUMBER: _ClassVar[int]
    BORDER_TEXELS_FIELD_NUMBER: _ClassVar[int]
    MIP_LEVELS_FIELD_NUMBER: _ClassVar[int]
    SNAP_TO_TEXELS_FIELD_NUMBER: _ClassVar[int]
    ROTATIONS_FIELD_NUMBER: _ClassVar[int]
    TEXEL_DENSITY_FIELD_NUMBER: _ClassVar[int]
    GROUP_BY_PART_FIELD_NUMBER: _ClassVar[int]
    TILES_FIELD_NUMBER: _ClassVar[int]
    MODE_FIELD_NUMBER: _ClassVar[int]
    REPACK_SCALE_FIELD_NUMBER: _ClassVar[int]
    TEXEL_WEIGHTS_FIELD_NUMBER: _ClassVar[int]
    QUALITY_FIELD_NUMBER: _ClassVar[int]
    CUT_BELOW_EFFICIENCY_FIELD_NUMBER: _ClassVar[int]
    max_area_distortion: float
    min_angular: float
    profile: str
    flattening: str
    denoise: str
    resolution: int
    gutter_texels: float
    deadline_s: float
    existing_uv: str
    scope: str
    only: _containers.RepeatedScalarFieldContainer[str]
    compress: str
    features: str
    parts: str
    border_texels: float
    mip_levels: int
    snap_to_texels: bool
    rotations: int
    texel_density: float
    group_by_part: str
    tiles: str
    mode: str
    repack_scale: str
    texel_weights: _containers.RepeatedScalarFieldContainer[str]
    quality: str
    cut_below_efficiency: float
    def __init__(self, max_area_distortion: _Optional[float] = ..., min_angular: _Optional[float] = ..., profile: _Optional[str] = ..., flattening: _Optional[str] = ..., denoise: _Optional[str] = ..., resolution: _Optional[int] = ..., gutter_texels: _Optional[float] = ..., deadline_s: _Optional[float] = ..., existing_uv: _Optional[str] = ..., scope: _Optional[str] = ..., only: _Optional[_Iterable[str]] = ..., compress: _Optional[str] = ..., features: _Optional[str] = ..., parts: _Optional[str] = ..., border_texels: _Optional[float] = ..., mip_levels: _Optional[int] = ..., snap_to_texels: _Optional[bool] = ..., rotations: _Optional[int] = ..., texel_density: _Optional[float] = ..., group_by_part: _Optional[str] = ..., tiles: _Optional[str] = ..., mode: _Optional[str] = ..., repack_scale: _Optional[str] = ..., texel_weights: _Optional[_Iterable[str]] = ..., quality: _Optional[str] = ..., cut_below_efficiency: _Optional[float] = ...) -> None: ...

class JobInput(_message.Message):
    __slots__ = ("sha256", "bytes", "faces")
    SHA256_FIELD_NUMBER: _ClassVar[int]
    BYTES_FIELD_NUMBER: _ClassVar[int]
    FACES_FIELD_NUMBER: _ClassVar[int]
    sha256: str
    bytes: int
    faces: int
    def __init__(self, sha256: _Optional[str] = ..., bytes: _Optional[int] = ..., faces: _Optional[int] = ...) -> None: ...

class Problem(_message.Message):
    __slots__ = ("type", "title", "status", "detail", "code", "instance", "errors")
    class Field(_message.Message):
        __slots__ = ("pointer", "detail")
        POINTER_FIELD_NUMBER: _ClassVar[int]
        DETAIL_FIELD_NUMBER: _ClassVar[int]
        pointer: str
        detail: str
        def __init__(self, pointer: _Optional[str] = ..., detail: _Optional[str] = ...) -> None: ...
    TYPE_FIELD_NUMBER: _ClassVar[int]
    TITLE_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    DETAIL_FIELD_NUMBER: _ClassVar[int]
    CODE_FIELD_NUMBER: _ClassVar[int]
    INSTANCE_FIELD_NUMBER: _ClassVar[int]
    ERRORS_FIELD_NUMBER: _ClassVar[int]
    type: str
    title: str
    status: int
    detail: str
    code: str
    instance: str
    errors: _containers.RepeatedCompositeFieldContainer[Problem.Field]
    def __init__(self, type: _Optional[str] = ..., title: _Optional[str] = ..., status: _Optional[int] = ..., detail: _Optional[str] = ..., code: _Optional[str] = ..., instance: _Optional[str] = ..., errors: _Optional[_Iterable[_Union[Problem.Field, _Mapping]]] = ...) -> None: ...

class WebhookDelivery(_message.Message):
    __slots__ = ("at", "attempt", "status", "error", "delivered")
    AT_FIELD_NUMBER: _ClassVar[int]
    ATTEMPT_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    ERROR_FIELD_NUMBER: _ClassVar[int]
    DELIVERED_FIELD_NUMBER: _ClassVar[int]
    at: _timestamp_pb2.Timestamp
    attempt: int
    status: int
    error: str
    delivered: bool
    def __init__(self, at: _Optional[_Union[datetime.datetime, _timestamp_pb2.Timestamp, _Mapping]] = ..., attempt: _Optional[int] = ..., status: _Optional[int] = ..., error: _Optional[str] = ..., delivered: _Optional[bool] = ...) -> None: ...

class Job(_message.Message):
    __slots__ = ("id", "status", "stage", "progress", "created_at", "started_at", "finished_at", "expires_at", "queue_position", "attempt", "cached", "options", "input", "report", "error", "webhook_deliveries")
    ID_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    STAGE_FIELD_NUMBER: _ClassVar[int]
    PROGRESS_FIELD_NUMBER: _ClassVar[int]
    CREATED_AT_FIELD_NUMBER: _ClassVar[int]
    STARTED_AT_FIELD_NUMBER: _ClassVar[int]
    FINISHED_AT_FIELD_NUMBER: _ClassVar[int]
    EXPIRES_AT_FIELD_NUMBER: _ClassVar[int]
    QUEUE_POSITION_FIELD_NUMBER: _ClassVar[int]
    ATTEMPT_FIELD_NUMBER: _ClassVar[int]
    CACHED_FIELD_NUMBER: _ClassVar[int]
    OPTIONS_FIELD_NUMBER: _ClassVar[int]
    INPUT_FIELD_NUMBER: _ClassVar[int]
    REPORT_FIELD_NUMBER: _ClassVar[int]
    ERROR_FIELD_NUMBER: _ClassVar[int]
    WEBHOOK_DELIVERIES_FIELD_NUMBER: _ClassVar[int]
    id: str
    status: JobStatus
    stage: str
    progress: float
    created_at: _timestamp_pb2.Timestamp
    started_at: _timestamp_pb2.Timestamp
    finished_at: _timestamp_pb2.Timestamp
    expires_at: _timestamp_pb2.Timestamp
    queue_position: int
    attempt: int
    cached: bool
    options: UnwrapOptions
    input: JobInput
    report: _struct_pb2.Struct
    error: Problem
    webhook_deliveries: _containers.RepeatedCompositeFieldContainer[WebhookDelivery]
    def __init__(self, id: _Optional[str] = ..., status: _Optional[_Union[JobStatus, str]] = ..., stage: _Optional[str] = ..., progress: _Optional[float] = ..., created_at: _Optional[_Union[datetime.datetime, _timestamp_pb2.Timestamp, _Mapping]] = ..., started_at: _Optional[_Union[datetime.datetime, _timestamp_pb2.Timestamp, _Mapping]] = ..., finished_at: _Optional[_Union[datetime.datetime, _timestamp_pb2.Timestamp, _Mapping]] = ..., expires_at: _Optional[_Union[datetime.datetime, _timestamp_pb2.Timestamp, _Mapping]] = ..., queue_position: _Optional[int] = ..., attempt: _Optional[int] = ..., cached: _Optional[bool] = ..., options: _Optional[_Union[UnwrapOptions, _Mapping]] = ..., input: _Optional[_Union[JobInput, _Mapping]] = ..., report: _Optional[_Union[_struct_pb2.Struct, _Mapping]] = ..., error: _Optional[_Union[Problem, _Mapping]] = ..., webhook_deliveries: _Optional[_Iterable[_Union[WebhookDelivery, _Mapping]]] = ...) -> None: ...

class GetJobRequest(_message.Message):
    __slots__ = ("id",)
    ID_FIELD_NUMBER: _ClassVar[int]
    id: str
    def __init__(self, id: _Optional[str] = ...) -> None: ...

class WatchJobRequest(_message.Message):
    __slots__ = ("id",)
    ID_FIELD_NUMBER: _ClassVar[int]
    id: str
    def __init__(self, id: _Optional[str] = ...) -> None: ...

class CancelJobRequest(_message.Message):
    __slots__ = ("id", "forget")
    ID_FIELD_NUMBER: _ClassVar[int]
    FORGET_FIELD_NUMBER: _ClassVar[int]
    id: str
    forget: bool
    def __init__(self, id: _Optional[str] = ..., forget: _Optional[bool] = ...) -> None: ...

class DownloadResultRequest(_message.Message):
    __slots__ = ("id", "file")
    class File(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        FILE_UNSPECIFIED: _ClassVar[DownloadResultRequest.File]
        FILE_GLB: _ClassVar[DownloadResultRequest.File]
        FILE_PREVIEW_PNG: _ClassVar[DownloadResultRequest.File]
        FILE_ATLAS_SVG: _ClassVar[DownloadResultRequest.File]
        FILE_PARTS_GLB: _ClassVar[DownloadResultRequest.File]
    FILE_UNSPECIFIED: DownloadResultRequest.File
    FILE_GLB: DownloadResultRequest.File
    FILE_PREVIEW_PNG: DownloadResultRequest.File
    FILE_ATLAS_SVG: DownloadResultRequest.File
    FILE_PARTS_GLB: DownloadResultRequest.File
    ID_FIELD_NUMBER: _ClassVar[int]
    FILE_FIELD_NUMBER: _ClassVar[int]
    id: str
    file: DownloadResultRequest.File
    def __init__(self, id: _Optional[str] = ..., file: _Optional[_Union[DownloadResultRequest.File, str]] = ...) -> None: ...

class DownloadResultResponse(_message.Message):
    __slots__ = ("description", "chunk")
    class Description(_message.Message):
        __slots__ = ("bytes", "sha256", "media_type")
        BYTES_FIELD_NUMBER: _ClassVar[int]
        SHA256_FIELD_NUMBER: _ClassVar[int]
        MEDIA_TYPE_FIELD_NUMBER: _ClassVar[int]
        bytes: int
        sha256: str
        media_type: str
        def __init__(self, bytes: _Optional[int] = ..., sha256: _Optional[str] = ..., media_type: _Optional[str] = ...) -> None: ...
    DESCRIPTION_FIELD_NUMBER: _ClassVar[int]
    CHUNK_FIELD_NUMBER: _ClassVar[int]
    description: DownloadResultResponse.Description
    chunk: bytes
    def __init__(self, description: _Optional[_Union[DownloadResultResponse.Description, _Mapping]] = ..., chunk: _Optional[bytes] = ...) -> None: ...
