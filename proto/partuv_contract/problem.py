"""Errors as clients see them: RFC 9457 problem details with a stable `code`."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from partuv_contract import service_errors
from partuv_contract.errors import PartuvError


class FieldProblem(BaseModel):
    """One place in the request or the file that is at fault."""

    pointer: str = Field(
        description="JSON pointer (RFC 6901) to the option, parameter or place in the glTF document"
    )
    detail: str = Field(description="What is wrong there")


class Problem(BaseModel):
    """What went wrong, for people and programs."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "type": "urn:partuv:problem:malformed_glb",
                    "title": "A GLB that breaks the glTF 2.0 specification",
                    "status": 422,
                    "detail": "accessor 0 reads past the end of its buffer view",
                    "code": "malformed_glb",
                    "errors": [{"pointer": "/accessors/0", "detail": "reads past the end"}],
                }
            ]
        }
    )

    type: str = Field(description="URN that names the kind of problem")
    title: str = Field(description="The kind of problem in words")
    status: int = Field(description="HTTP status", ge=400, le=599)
    detail: str = Field(description="This very problem in words")
    code: str = Field(description="Stable word that programs branch on; new ones may appear")
    instance: str | None = Field(default=None, description="The job or request it belongs to")
    errors: list[FieldProblem] = Field(default_factory=list, description="Places at fault")

    @classmethod
    def of(cls, error: PartuvError, instance: str | None = None) -> Problem:
        """The problem that tells an error."""
        return cls(
            type=f"urn:partuv:problem:{error.code}",
            title=title_of(type(error)),
            status=error.http_status,
            detail=str(error),
            code=error.code,
            instance=instance,
            errors=(
                []
                if error.pointer is None
                else [FieldProblem(pointer=error.pointer, detail=error.message)]
            ),
        )


def title_of(kind: type[PartuvError]) -> str:
    """The kind of error in words: the first line of its docstring."""
    return (kind.__doc__ or kind.code).strip().partition("\n")[0].rstrip(".")


def error_kinds() -> dict[str, type[PartuvError]]:
    """Every kind of error by its code, sorted: the whole tree, this service's part included."""
    assert service_errors  # imported so that its classes are there to be found
    kinds: dict[str, type[PartuvError]] = {}
    line: list[type[PartuvError]] = [PartuvError]
    while line:
        kind = line.pop()
        kinds.setdefault(kind.code, kind)
        line += kind.__subclasses__()
    return dict(sorted(kinds.items()))
