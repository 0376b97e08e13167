import re
from pathlib import Path

from partuv_worker.glb.limits import Limits

DOCUMENT = Path(__file__).parents[4] / "docs" / "gltf.md"


def test_the_document_lists_every_limit_with_its_default():
    listed = re.findall(r"^\| `(\w+)` \| (\d+) \| (.+) \|$", DOCUMENT.read_text(), re.MULTILINE)
    fields = Limits.model_fields
    assert listed == [
        (name, str(field.default), field.description) for name, field in fields.items()
    ]
