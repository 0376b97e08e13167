"""Why a call failed: one tree of exceptions with stable codes.

PartuvError
├── InputError                 the uploaded bytes are at fault
│   ├── NotGlbError            not_glb: no binary glTF 2.0 container
│   ├── MalformedGlbError      malformed_glb: breaks the glTF 2.0 specification
│   ├── UnsupportedError       unsupported_feature: valid, but not handled here
│   ├── ExternalUriError       external_uri: names a file or address outside the GLB
│   ├── LimitError             limit_exceeded: larger than this installation allows
│   ├── NoTrianglesError       no_triangles: nothing that could be unwrapped
│   ├── NonFinitePositionError non_finite_position: a position is NaN or infinite
│   ├── NoAreaError            no_face_with_area: every triangle is degenerate
│   └── UnusableUvError        unusable_uv: charts to keep that are missing or degenerate
├── OptionError                invalid_option: an option is out of its range
├── FeaturesError              features_unavailable: the part features can't be computed here
│   └── CheckpointError        bad_checkpoint: the file is not the network, damaged or hostile
├── CancelledError             cancelled: the caller asked to stop
└── ComponentMissingError      component_missing: not part of this installation

Codes are part of the interface: programs branch on them, people read the message.
"""

from __future__ import annotations

from typing import Any, ClassVar


class PartuvError(Exception):
    """Something unexpected; all errors a caller can be told about are kinds of it.

    `pointer` is a JSON pointer (RFC 6901) into the glTF document, or the path of an option;
    `byte_offset` counts from the start of the file. Either may be missing.
    """

    code: ClassVar[str] = "internal"
    http_status: ClassVar[int] = 500
    grpc_status: ClassVar[str] = "INTERNAL"

    def __init__(
        self, message: str, *, pointer: str | None = None, byte_offset: int | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.pointer = pointer
        self.byte_offset = byte_offset

    def __str__(self) -> str:
        where = []
        if self.pointer is not None:
            where.append(f"at {self.pointer or '/'}")
        if self.byte_offset is not None:
            where.append(f"at byte {self.byte_offset}")
        return f"{self.message} ({', '.join(where)})" if where else self.message

    def as_dict(self) -> dict[str, Any]:
        """The error as JSON: `code`, `message`, and `pointer` or `byte_offset` where known."""
        known = {"pointer": self.pointer, "byte_offset": self.byte_offset}
        return {"code": self.code, "message": self.message} | {
            key: value for key, value in known.items() if value is not None
        }


class InputError(PartuvError):
    """The uploaded bytes are at fault."""

    code = "invalid_input"
    http_status = 422
    grpc_status = "INVALID_ARGUMENT"


class NotGlbError(InputError):
    """The bytes are not a binary glTF 2.0 container."""

    code = "not_glb"
    http_status = 415


class MalformedGlbError(InputError):
    """A GLB that breaks the glTF 2.0 specification."""

    code = "malformed_glb"


class UnsupportedError(InputError):
    """A valid GLB with a feature that is not handled here."""

    code = "unsupported_feature"


class ExternalUriError(InputError):
    """A buffer that lies outside the GLB; nothing outside is ever opened."""

    code = "external_uri"


class LimitError(InputError):
    """An input larger than this installation allows."""

    code = "limit_exceeded"
    http_status = 413
    grpc_status = "RESOURCE_EXHAUSTED"


class NoTrianglesError(InputError):
    """Nothing in the scene could be unwrapped."""

    code = "no_triangles"


class NonFinitePositionError(InputError):
    """A position is NaN or infinite; the message names the accessor."""

    code = "non_finite_position"


class NoAreaError(InputError):
    """Every triangle is degenerate: there is no surface to flatten."""

    code = "no_face_with_area"


class UnusableUvError(InputError):
    """A UV set that can't be packed anew; `pointer` and message name the primitive."""

    code = "unusable_uv"


class OptionError(PartuvError):
    """An option is unknown or out of its range; `pointer` names it."""

    code = "invalid_option"
    http_status = 422
    grpc_status = "INVALID_ARGUMENT"


class FeaturesError(PartuvError):
    """The part features that were asked for can't be computed by this installation."""

    code = "features_unavailable"
    http_status = 503
    grpc_status = "UNAVAILABLE"


class CheckpointError(FeaturesError):
    """A checkpoint that is missing, damaged, hostile or of another network."""

    code = "bad_checkpoint"


class CancelledError(PartuvError):
    """The caller asked to stop."""

    code = "cancelled"
    http_status = 409
    grpc_status = "CANCELLED"


class ComponentMissingError(PartuvError):
    """A command or feature whose component is not part of this installation."""

    code = "component_missing"
    http_status = 501
    grpc_status = "UNIMPLEMENTED"
