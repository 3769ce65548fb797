"""The Python in the documentation runs, block after block, as a reader would type it."""

import re
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent.parent
PAGES = [HERE / "README.md", *sorted((HERE.parent.parent / "docs" / "python").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_code_of_a_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = page.read_text()
    names = {"__name__": "__main__"}
    blocks = list(re.finditer(r"^```python(.*?)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))
    assert blocks
    for block in blocks:
        needed = re.search(r"needs=(\w+)", block.group(1))
        if needed:
            pytest.importorskip(needed.group(1))
        line = text[: block.start(2)].count("\n")
        exec(compile("\n" * line + block.group(2), page, "exec"), names)
