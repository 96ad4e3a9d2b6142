"""What is left when all pages are built: thumbnails of the gallery, and whether links within the site lead anywhere."""

from __future__ import annotations

import base64
import io
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from PIL import Image

#: The pages of the gallery, in its order.
TUTORIALS = (
    "tutorial",
    "robot",
    "pymoo_way",
    "own_cost",
    "extend",
    "reproduce",
    "compare",
    "planners",
    "moving",
    "three",
)
#: Most words of one, code included: ten minutes at two hundred a minute.
MOST_WORDS = 2000
#: Width and height of a thumbnail, in pixels.
THUMBNAIL = (480, 300)
# Pages of the theme's own, and those that a search fills.
_NOT_OURS = ("search.html", "genindex.html", "py-modindex.html")


class Page(HTMLParser):
    """What a page refers to, and what can be referred to in it."""

    def __init__(self, text: str):
        super().__init__()
        self.links: list[str] = []
        self.images: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = {name: value for name, value in attrs if value}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag in ("a", "link") and "href" in given:
            self.links.append(given["href"])
        if tag in ("img", "script", "iframe") and "src" in given:
            self.links.append(given["src"])
        if tag == "img" and "src" in given:
            self.images.append(given["src"])


def read_pages(folder: Path) -> dict[Path, Page]:
    """Return the pages of a site by their files."""
    return {file: Page(file.read_text(encoding="utf-8")) for file in sorted(folder.rglob("*.html"))}


def draw_thumbnails(folder: Path, pages: dict[Path, Page]) -> list[str]:
    """Make a thumbnail of the last figure of each tutorial, and return what is wrong with any."""
    wrong = []
    for name in TUTORIALS:
        page = pages.get(folder / f"{name}.html")
        figures = [] if page is None else [src for src in page.images if "_images/" in src or src.startswith("data:image")]
        if not figures:
            wrong.append(f"{name}: expected a figure at the end of each tutorial, found none")
            continue
        last = figures[-1]
        embedded = last.startswith("data:")
        data = base64.b64decode(last.partition(",")[2]) if embedded else (folder / unquote(last)).read_bytes()
        with Image.open(io.BytesIO(data)) as image:
            small = image.convert("RGBA")
            small.thumbnail(THUMBNAIL)
            plain = Image.new("RGBA", THUMBNAIL, "white")
            plain.alpha_composite(small, tuple((room - side) // 2 for room, side in zip(THUMBNAIL, small.size, strict=True)))
            plain.convert("RGB").save(folder / "_images" / f"thumbnail-{name}.png", optimize=True)
    return wrong


def broken_links(folder: Path, pages: dict[Path, Page]) -> list[str]:
    """Return the links within the site that lead to no file, or to no such place in it."""
    wrong = []
    for file, page in pages.items():
        if file.name in _NOT_OURS or "_static" in file.parts:
            continue
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not target.is_file():
                wrong.append(f"{file.relative_to(folder)}: {link} leads to no file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                wrong.append(f"{file.relative_to(folder)}: {link} leads to no such place")
    return wrong


def long_tutorials(source: Path) -> list[str]:
    """Return which tutorials take longer to read than ten minutes."""
    counts = {name: len((source / f"{name}.md").read_text(encoding="utf-8").split()) for name in TUTORIALS}
    return [f"{name}: {n} words, expected at most {MOST_WORDS}" for name, n in counts.items() if n > MOST_WORDS]
