"""UV unwrapping: a triangle mesh in, a verified atlas out."""

from ._core import Atlas, Context, Flattener, Options, Profile, flatten, unwrap
from ._errors import EngineError

__all__ = ["Atlas", "Context", "EngineError", "Flattener", "Options", "Profile", "flatten", "unwrap"]
