"""The glTF extensions that can be required of us, and what they refer to.

A patcher passes most extensions through: it matters only that they change no geometry, and where
they name buffer views, so that those are kept. An extension that is not listed here is passed
through too when it is optional, but then no buffer view is ever removed or renumbered.
"""

from __future__ import annotations

from partuv_contract.errors import UnsupportedError

from partuv_worker.glb.cursor import Cursor

DRACO = "KHR_draco_mesh_compression"
MESHOPT = "EXT_meshopt_compression"
MESHOPT_NAMES = (MESHOPT, "KHR_meshopt_compression")
QUANTIZATION = "KHR_mesh_quantization"
TEXTURE_TRANSFORM = "KHR_texture_transform"
VARIANTS = "KHR_materials_variants"
ANIMATION_POINTER = "KHR_animation_pointer"
INSTANCING = "EXT_mesh_gpu_instancing"

_PASSED_THROUGH = frozenset(
    {
        "EXT_lights_ies",
        "EXT_texture_avif",
        "EXT_texture_webp",
        "KHR_lights_punctual",
        "KHR_materials_anisotropy",
        "KHR_materials_clearcoat",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_dispersion",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_iridescence",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_sheen",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_volume",
        "KHR_node_hoverability",
        "KHR_node_selectability",
        "KHR_node_visibility",
        "KHR_texture_basisu",
        "KHR_xmp_json_ld",
        "MSFT_texture_dds",
    }
)
UNDERSTOOD = _PASSED_THROUGH | {
    DRACO,
    *MESHOPT_NAMES,
    QUANTIZATION,
    TEXTURE_TRANSFORM,
    VARIANTS,
    INSTANCING,
    ANIMATION_POINTER,
}


def check_required(root: Cursor) -> None:
    """Refuse a document that requires an extension we do not understand."""
    for cursor in root.elements("extensionsRequired"):
        name = cursor.as_text()
        if name not in UNDERSTOOD:
            raise UnsupportedError(
                f"the file requires the extension {name[:80]}, which is not supported",
                pointer=cursor.pointer,
            )


def only_understood(root: Cursor) -> bool:
    """Whether every reference to a buffer view is in a place that we know."""
    return all(cursor.as_text() in UNDERSTOOD for cursor in root.elements("extensionsUsed"))
