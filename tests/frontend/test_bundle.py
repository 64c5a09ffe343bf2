"""What a browser must load before the first page shows anything, compressed as a web server would send it."""

import gzip
import re
from pathlib import Path

import pytest

STATIC = Path(__file__).resolve().parents[2] / "app" / "static"
MOST_BYTES = 500_000


def test_the_first_load_is_small() -> None:
    index = STATIC / "index.html"
    if not index.is_file():
        pytest.skip("the page is not built; run `make frontend`")
    html = index.read_text(encoding="utf-8")
    named = {Path(path).name for path in re.findall(r'(?:src|href)="/(assets/[^"]+)"', html)}
    # The review page comes in a part of its own, which its address asks for at once; the font is woff2 already.
    review = {path.name for path in (STATIC / "assets").glob("ReviewPage-*") if path.suffix in (".js", ".css")}
    assert named, "the index names no part of the page"
    assert review, "the review page is no part of its own any more"
    sizes = {name: len(gzip.compress((STATIC / "assets" / name).read_bytes())) for name in named | review}
    sizes |= {path.name: path.stat().st_size for path in (STATIC / "assets").glob("inter-latin-wght-*.woff2")}
    assert sum(sizes.values()) < MOST_BYTES, sizes
