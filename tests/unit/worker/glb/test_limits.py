import re
from pathlib import Path

from partuv_worker.glb.limits import Limits

ROOT = Path(__file__).parents[4]


def test_the_document_lists_every_limit_with_its_default():
    text = (ROOT / "docs" / "gltf.md").read_text()
    listed = re.findall(r"^\| `(\w+)` \| (\d+) \| (.+) \|$", text, re.MULTILINE)
    fields = Limits.model_fields
    assert listed == [
        (name, str(field.default), field.description) for name, field in fields.items()
    ]


def test_the_readme_has_the_same_defaults():
    section = (ROOT / "README.md").read_text().partition("## Limits")[2].partition("\n## ")[0]
    listed = re.findall(r"`(\w+)`[^|]*\| ([\d,]+)(?: (MiB|GiB))? \|", section)
    units = {"": 1, "MiB": 1 << 20, "GiB": 1 << 30}
    defaults = {name: int(number.replace(",", "")) * units[unit] for name, number, unit in listed}
    assert defaults == {name: field.default for name, field in Limits.model_fields.items()}
