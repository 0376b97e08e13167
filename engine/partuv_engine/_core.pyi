"""Native core of partuv_engine"""

from collections.abc import Sequence
import enum
from typing import Annotated, overload

import numpy
from numpy.typing import NDArray


class Context:
    """Cancel flag, deadline, thread count and progress of one engine call."""

    def __init__(self, threads: int = 1, deadline_s: float | None = None) -> None: ...

    def cancel(self) -> None:
        """Ask the call to stop; any thread may."""

    @property
    def cancelled(self) -> bool: ...

    @property
    def threads(self) -> int: ...

    @property
    def progress(self) -> tuple[float, str]:
        """(fraction in [0, 1], stage); the fraction never falls."""

def flatten(positions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], *, max_area_distortion: float = 1.25, min_angular: float = 0.95, polish: bool = True, angle_based: bool = True) -> dict:
    """
    Flatten a connected mesh with boundary as one chart, without cutting it.
    """

class Proxy:
    """A coarse stand-in for a surface, with the way back to it."""

    @property
    def positions(self) -> NDArray[numpy.float64]: ...

    @property
    def faces(self) -> NDArray[numpy.int32]: ...

    @property
    def opposite(self) -> NDArray[numpy.int32]: ...

    @property
    def proxy_of_face(self) -> NDArray[numpy.int32]:
        """proxy face of each face of the source"""

class Surface:
    """
    A mesh welded into an oriented manifold of unit area about the origin. Faces that repeat a welded point are left out: see source_face.
    """

    def __init__(self, positions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], canonical: bool = False) -> None:
        """
        canonical: number and place it as an unwrap does, however it is numbered and lies.
        """

    @property
    def face_count(self) -> int: ...

    @property
    def source_face(self) -> NDArray[numpy.int32]:
        """For each face of the surface, the face of the mesh it is."""

    @property
    def positions(self) -> NDArray[numpy.float64]: ...

    @property
    def faces(self) -> NDArray[numpy.int32]: ...

    @property
    def opposite(self) -> NDArray[numpy.int32]:
        """
        F x 3: the half-edge 3 * face + side on the other side, -1 at a boundary
        """

    def noise(self) -> float:
        """
        Angle (rad) by which the bend at a typical vertex differs from its neighbours'.
        """

    def denoised(self, strength: float | None, context: Context | None = None) -> Surface:
        """
        The surface after `strength` half-step Laplacian passes; None: as many as it needs.
        """

    def simplified(self, target_faces: int, max_error: float, context: Context | None = None) -> Proxy:
        """A proxy of the same topology with about `target_faces` faces."""

    def lift(self, proxy: Proxy, labels: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], band_edges: float, context: Context | None = None) -> NDArray[numpy.int32]:
        """Labels per face from labels per proxy face, with straight boundaries."""

class Grouping(enum.Enum):
    """How charts of one part lie to each other."""

    none = 0

    near = 1

    strict = 2

class PackOptions:
    """Options of a packing; see partuv/pack.hpp."""

    def __init__(self) -> None: ...

    @property
    def resolution(self) -> int: ...

    @resolution.setter
    def resolution(self, arg: int, /) -> None: ...

    @property
    def gutter_texels(self) -> float: ...

    @gutter_texels.setter
    def gutter_texels(self, arg: float, /) -> None: ...

    @property
    def border_texels(self) -> float: ...

    @border_texels.setter
    def border_texels(self, arg: float, /) -> None: ...

    @property
    def mip_levels(self) -> int: ...

    @mip_levels.setter
    def mip_levels(self, arg: int, /) -> None: ...

    @property
    def snap_to_texels(self) -> bool: ...

    @snap_to_texels.setter
    def snap_to_texels(self, arg: bool, /) -> None: ...

    @property
    def rotations(self) -> int: ...

    @rotations.setter
    def rotations(self, arg: int, /) -> None: ...

    @property
    def texel_density(self) -> float: ...

    @texel_density.setter
    def texel_density(self, arg: float, /) -> None: ...

    @property
    def group_by_part(self) -> Grouping: ...

    @group_by_part.setter
    def group_by_part(self, arg: Grouping, /) -> None: ...

    @property
    def tiles(self) -> int: ...

    @tiles.setter
    def tiles(self, arg: int, /) -> None: ...

    @property
    def effort(self) -> float: ...

    @effort.setter
    def effort(self, arg: float, /) -> None: ...

class Packed:
    """Charts in their places."""

    @property
    def corner_uv(self) -> NDArray[numpy.float32]:
        """F x 3 x 2, V up, in the unit square of each face's tile"""

    @property
    def tile(self) -> NDArray[numpy.int32]:
        """tile of each chart"""

    @property
    def rotation_rad(self) -> NDArray[numpy.float64]:
        """turn of each chart"""

    @property
    def scale(self) -> NDArray[numpy.float64]:
        """size of each chart in its tile, relative to the given one"""

    @property
    def tiles(self) -> dict:
        """
        dict of arrays: charts, efficiency, covered_texels, gutter_texels, seconds
        """

    @property
    def efficiency(self) -> float: ...

def pack(uv: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], chart: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], options: PackOptions, context: Context, *, part: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)] | None = None, weight: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)] | None = None) -> Packed:
    """
    Pack given charts: uv N x 2 float64, faces F x 3 int32, chart F int32; part int32 and
    weight float64 per chart.
    """

class PartTree:
    """
    Binary merge tree over F faces: nodes 0..F-1 are the faces, F..2F-2 the merges in order; the faces of a node are order[begin[node]:end[node]].
    """

    @property
    def face_count(self) -> int: ...

    @property
    def left(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]: ...

    @property
    def right(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]: ...

    @property
    def order(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]: ...

    @property
    def begin(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]: ...

    @property
    def end(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]: ...

    def restrict(self, representatives: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> PartTree:
        """
        The tree induced on some of the faces: leaf i is face representatives[i].
        """

def build_nbm_tree(surface: Surface, convex_weight: float = 0.15, contrast: float = 2.0, least_similarity: float = 0.02, context: Context | None = None) -> PartTree:
    """The built-in part tree: short, concave cuts at the top."""

@overload
def build_ward_tree(surface: Surface, features: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], context: Context | None = None) -> PartTree:
    """
    Area-weighted Ward clustering of features, a row per face of the surface.
    """

@overload
def build_ward_tree(surface: Surface, features: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], context: Context | None = None) -> PartTree: ...

def import_tree(face_count: int, nodes: Annotated[NDArray[numpy.int64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> PartTree:
    """A tree from its merges, rows of (id, left, right) in any order."""

def read_tree_file(face_count: int, file: bytes) -> PartTree:
    """A tree from the bytes of a PartUV tree file."""

def build_part_tree(surface: Surface, context: Context | None = None) -> PartTree:
    """
    The tree for parts that people would name: convex creases do not count.
    """

def cut_tree(surface: Surface, tree: PartTree, parts: int) -> NDArray[numpy.int32]:
    """
    Part of each face of the mesh once the last parts - 1 merges are undone.
    """

def cut_tree_auto(surface: Surface, tree: PartTree) -> NDArray[numpy.int32]:
    """
    Part of each face of the mesh for as many parts as people are likely to name.
    """

class Profile(enum.Enum):
    """What a chart may cost."""

    balanced = 0

    conformal = 1

class Flattener(enum.Enum):
    """How a chart is first flattened."""

    abf = 0

    lscm = 1

class TexelWeights:
    """Texel densities relative to others."""

    @property
    def face(self) -> list[float]: ...

    @face.setter
    def face(self, arg: Sequence[float], /) -> None: ...

    @property
    def part(self) -> list[tuple[int, float]]: ...

    @part.setter
    def part(self, arg: Sequence[tuple[int, float]], /) -> None: ...

class Quality(enum.Enum):
    """How much work an atlas may take."""

    fast = 0

    standard = 1

    best = 2

class Options(PackOptions):
    """Options of one unwrap; see partuv/options.hpp."""

    def __init__(self) -> None: ...

    @property
    def max_area_distortion(self) -> float: ...

    @max_area_distortion.setter
    def max_area_distortion(self, arg: float, /) -> None: ...

    @property
    def min_angular(self) -> float: ...

    @min_angular.setter
    def min_angular(self, arg: float, /) -> None: ...

    @property
    def profile(self) -> Profile: ...

    @profile.setter
    def profile(self, arg: Profile, /) -> None: ...

    @property
    def flattening(self) -> Flattener: ...

    @flattening.setter
    def flattening(self, arg: Flattener, /) -> None: ...

    @property
    def quality(self) -> Quality: ...

    @quality.setter
    def quality(self, arg: Quality, /) -> None: ...

    @property
    def denoise(self) -> float: ...

    @denoise.setter
    def denoise(self, arg: float, /) -> None: ...

    @property
    def cut_below_efficiency(self) -> float: ...

    @cut_below_efficiency.setter
    def cut_below_efficiency(self, arg: float, /) -> None: ...

    @property
    def parts(self) -> int: ...

    @parts.setter
    def parts(self, arg: int, /) -> None: ...

    @property
    def texel_weights(self) -> TexelWeights: ...

    @texel_weights.setter
    def texel_weights(self, arg: TexelWeights, /) -> None: ...

class Ablation:
    """Steps of an unwrap to leave out; see partuv/ablation.hpp."""

    def __init__(self) -> None: ...

    @property
    def proxy(self) -> bool: ...

    @proxy.setter
    def proxy(self, arg: bool, /) -> None: ...

    @property
    def merge_heuristic(self) -> bool: ...

    @merge_heuristic.setter
    def merge_heuristic(self, arg: bool, /) -> None: ...

    @property
    def recursion(self) -> bool: ...

    @recursion.setter
    def recursion(self, arg: bool, /) -> None: ...

    @property
    def final_merge(self) -> bool: ...

    @final_merge.setter
    def final_merge(self, arg: bool, /) -> None: ...

    @property
    def cut_open(self) -> bool: ...

    @cut_open.setter
    def cut_open(self, arg: bool, /) -> None: ...

    @property
    def polish(self) -> bool: ...

    @polish.setter
    def polish(self, arg: bool, /) -> None: ...

    @property
    def fixed_parts(self) -> int: ...

    @fixed_parts.setter
    def fixed_parts(self, arg: int, /) -> None: ...

class Atlas:
    """UVs, charts and figures of an unwrapped mesh."""

    @property
    def corner_uv(self) -> NDArray[numpy.float32]:
        """F x 3 x 2, V up, in the unit square, multiples of 2^-24"""

    @property
    def chart(self) -> NDArray[numpy.int32]:
        """chart of each face"""

    @property
    def part(self) -> NDArray[numpy.int32]:
        """part of each face"""

    @property
    def tile(self) -> NDArray[numpy.int32]:
        """tile of each face"""

    @property
    def charts(self) -> dict:
        """dict of arrays: faces, part, tile, area_3d, area_distortion, angular"""

    @property
    def tiles(self) -> dict:
        """
        dict of arrays: charts, efficiency, covered_texels, gutter_texels, seconds
        """

    @property
    def part_count(self) -> int: ...

    @property
    def efficiency(self) -> float: ...

    @property
    def noise(self) -> float: ...

    @property
    def proxy_faces(self) -> int: ...

    @property
    def searched_charts(self) -> int: ...

    @property
    def stage_seconds(self) -> list[tuple[str, float]]: ...

def unwrap(positions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], options: Options, context: Context, *, features: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None = None, tree: PartTree | None = None, ablation: Ablation = ...) -> Atlas:
    """
    Unwrap a mesh: positions V x 3 float64, faces F x 3 int32. The part tree is the built-in one,
    or comes from features (F x d float32), or is given (over the faces).
    """
