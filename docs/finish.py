"""What is left when all pages are built: thumbnails of the gallery, whether links lead anywhere, and what is too much."""

from __future__ import annotations

import base64
import io
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from PIL import Image, ImageChops, ImageOps

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
#: Most words of one, with the code that is shown but not what it prints: ten minutes at two hundred a minute.
MOST_WORDS = 2000
#: Most lines that a piece of code prints in one.
MOST_LINES = 40
#: Most columns of code, which scrolls out of sight beyond.
MOST_COLUMNS = 108
#: Most columns of a table that is printed, whose rows would go on in the next line beyond.
MOST_PRINTED = 117
#: Width and height of a thumbnail, in pixels.
THUMBNAIL = (480, 300)
# Pages of the theme's own, and those that a search fills.
_NOT_OURS = ("search.html", "genindex.html", "py-modindex.html")


# Elements that have no end.
_VOID = frozenset(["area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "track", "wbr"])


class Page(HTMLParser):
    """What a page refers to, what can be referred to in it, and what there is to read."""

    def __init__(self, text: str):
        super().__init__()
        self.links: list[str] = []
        self.images: list[str] = []
        self.anchors: set[str] = set()
        #: What is shown without a click: text and code, but not what the code prints.
        self.text = ""
        self.code: list[str] = []
        self.outputs: list[str] = []
        self._open: list[tuple[str, str]] = []
        self.feed(text)

    @property
    def words(self) -> int:
        return len(self.text.split())

    def handle_starttag(self, tag, attrs):
        given = {name: value for name, value in attrs if value}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag in ("a", "link") and "href" in given:
            self.links.append(given["href"])
        if tag in ("img", "script", "iframe") and "src" in given:
            self.links.append(given["src"])
        if tag == "img" and "src" in given:
            self.images.append(given["src"])
        if tag not in _VOID:
            self._open.append((tag, given.get("class", "")))
        if tag == "pre":
            (self.outputs if self._is_output() else self.code).append("")

    def handle_endtag(self, tag):
        if any(tag == name for name, _ in self._open):
            while self._open.pop()[0] != tag:
                pass

    def handle_data(self, data):
        tags = {tag for tag, _ in self._open}
        if "article" not in tags or tags & {"script", "style"}:
            return
        if "pre" in tags:
            blocks = self.outputs if self._is_output() else self.code
            blocks[-1] += data
        if "details" not in tags and not self._is_output():
            self.text += data

    def _is_output(self) -> bool:
        return any("cell_output" in classes for _, classes in self._open)


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
            small = ImageOps.contain(_without_margins(image.convert("RGBA")), THUMBNAIL, Image.Resampling.LANCZOS)
            plain = Image.new("RGBA", THUMBNAIL, "white")
            plain.alpha_composite(small, tuple((room - side) // 2 for room, side in zip(THUMBNAIL, small.size, strict=True)))
            plain.convert("RGB").save(folder / "_images" / f"thumbnail-{name}.png", optimize=True)
    return wrong


def _without_margins(image: Image.Image) -> Image.Image:
    """Return a picture without the white around it."""
    white = Image.new("RGBA", image.size, "white")
    drawn = Image.alpha_composite(white, image)
    box = ImageChops.difference(drawn.convert("RGB"), white.convert("RGB")).getbbox()
    return drawn.crop(box)


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


def long_tutorials(folder: Path, pages: dict[Path, Page]) -> list[str]:
    """Return which tutorials take longer to read than ten minutes, and in which some code prints too much."""
    wrong = []
    for name in TUTORIALS:
        page = pages[folder / f"{name}.html"]
        if page.words > MOST_WORDS:
            wrong.append(f"{name}: {page.words} words, expected at most {MOST_WORDS}")
        for output in page.outputs:
            if (n := output.strip().count("\n") + 1) > MOST_LINES:
                wrong.append(f"{name}: {n} lines printed, expected at most {MOST_LINES}: {output.strip()[:60]!r}")
    return wrong


def wide_lines(folder: Path, pages: dict[Path, Page]) -> list[str]:
    """Return the lines of code and of printed tables that are too wide to be seen whole, those of the reference aside."""
    wrong = []
    for file, page in pages.items():
        if "api" in file.relative_to(folder).parts:
            continue
        lines = [(line, MOST_COLUMNS) for block in page.code for line in block.splitlines()]
        # Sentences may go on in the next line.
        lines += [(line, MOST_PRINTED) for block in page.outputs for line in block.splitlines() if "   " in line]
        for line, most in lines:
            if len(line) > most:
                wrong.append(f"{file.relative_to(folder)}: {len(line)} columns, expected at most {most}: {line.strip()[:60]!r}")
    return wrong
