"""What the documentation checks when it is built: links within the site, and that tutorials have one form."""

from __future__ import annotations

import base64
import importlib.util
import io
import tomllib
from pathlib import Path

import pytest
from PIL import Image

DOCS = Path(__file__).parent.parent / "docs"
SPEC = importlib.util.spec_from_file_location("finish", DOCS / "finish.py")
assert SPEC is not None and SPEC.loader is not None
finish = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(finish)


def site(folder, **pages):
    for name, body in pages.items():
        (folder / f"{name}.html").write_text(f"<html><body>{body}</body></html>", encoding="utf-8")
    return finish.read_pages(folder)


def test_links_that_lead_nowhere_are_named(tmp_path):
    (tmp_path / "a picture.png").write_bytes(b"")
    one = '<h1 id="top"></h1><a href="two.html#there">x</a><a href="#top">x</a><img src="a%20picture.png">'
    one += '<a href="two.html#gone">x</a><a href="three.html">x</a><a href="#end">x</a><a href="https://pymoo.org/no">x</a>'
    pages = site(tmp_path, one=one, two='<p id="there"><a href="mailto:a@b.org">x</a></p>')
    wrong = finish.broken_links(tmp_path, pages)
    assert [line.split()[1] for line in wrong] == ["two.html#gone", "three.html", "#end"]
    assert all(line.startswith("one.html: ") for line in wrong)


def test_thumbnails_are_of_the_last_figure(tmp_path, monkeypatch):
    monkeypatch.setattr(finish, "TUTORIALS", ("walk", "bare", "missing"))
    (tmp_path / "_images").mkdir()
    encoded = io.BytesIO()
    Image.new("RGB", (90, 30), "red").save(encoded, "gif")
    data = base64.b64encode(encoded.getvalue()).decode()
    pages = site(tmp_path, walk=f'<img src="_images/first.png"><img src="data:image/gif;base64,{data}">', bare="<p></p>")
    wrong = finish.draw_thumbnails(tmp_path, pages)
    assert [line.split(":")[0] for line in wrong] == ["bare", "missing"]
    with Image.open(tmp_path / "_images" / "thumbnail-walk.png") as image:
        assert image.size == finish.THUMBNAIL
        assert image.getpixel((240, 150)) == (254, 0, 0) or image.getpixel((240, 150)) == (255, 0, 0)
        assert image.getpixel((0, 0)) == (255, 255, 255)


@pytest.mark.parametrize("name", finish.TUTORIALS)
def test_a_tutorial_begins_with_a_question_and_stands_in_the_gallery(name):
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    title, _, rest = text.partition("\n# ")[2].partition("\n")
    assert "?" in rest.strip().split("\n\n")[0], title
    assert "{code-cell}" in text
    gallery = (DOCS / "tutorials.md").read_text(encoding="utf-8")
    assert f"thumbnail-{name}.png" in gallery and f"({name}.md)" in gallery and f"<{name}>" in gallery


def test_there_are_ten_tutorials():
    assert len(finish.TUTORIALS) == 10


def article(body):
    return f'<nav>not read</nav><article class="bd-article">{body}</article>'


def test_what_is_shown_without_a_click_is_what_takes_time_to_read(tmp_path, monkeypatch):
    monkeypatch.setattr(finish, "TUTORIALS", ("short", "long"))
    shown = '<p>four words <br>of text</p>\n<div class="cell"><pre><span>two</span><span>_in</span> one</pre></div>\n'
    skipped = "<details><summary>Ponds</summary><pre>many words of code</pre></details>"
    skipped += '<div class="cell_output docutils"><pre>what it prints</pre></div>'
    pages = site(tmp_path, short=article(shown + skipped), long=article("<p>" + "word " * (finish.MOST_WORDS + 1) + "</p>"))
    assert pages[tmp_path / "short.html"].words == 6
    assert [line.split(",")[0] for line in finish.long_tutorials(tmp_path, pages)] == [f"long: {finish.MOST_WORDS + 1} words"]


def test_output_that_is_long_and_code_that_is_wide_are_named(tmp_path, monkeypatch):
    monkeypatch.setattr(finish, "TUTORIALS", ("talk",))
    most, columns = finish.MOST_LINES, finish.MOST_COLUMNS
    talk = "".join(f'<div class="cell_output"><pre>{"x" * 200}{chr(10) * n}y</pre></div>' for n in (most - 1, most))
    table = f'<div class="cell_output"><pre>a table   {"c" * finish.MOST_PRINTED}</pre></div>'
    pages = site(tmp_path, talk=article(talk), wide=article(f"<pre>{'a' * columns}\n{'b' * (columns + 1)}</pre>{table}"))
    (line,) = finish.long_tutorials(tmp_path, pages)
    assert line.startswith(f"talk: {most + 1} lines")
    code, printed = finish.wide_lines(tmp_path, pages)
    assert code.startswith(f"wide.html: {columns + 1} columns") and "bbb" in code
    assert printed.startswith(f"wide.html: {finish.MOST_PRINTED + 10} columns")


def test_thumbnails_have_no_margins(tmp_path, monkeypatch):
    monkeypatch.setattr(finish, "TUTORIALS", ("walk",))
    (tmp_path / "_images").mkdir()
    figure = Image.new("RGB", (480, 300), "white")
    figure.paste("red", (200, 140, 280, 190))
    figure.save(tmp_path / "_images" / "figure.png")
    assert not finish.draw_thumbnails(tmp_path, site(tmp_path, walk='<img src="_images/figure.png">'))
    with Image.open(tmp_path / "_images" / "thumbnail-walk.png") as image:
        assert image.getpixel((2, 2)) == (255, 0, 0) and image.size == finish.THUMBNAIL


def test_pages_run_on_compiled_kernels():
    extras = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    (package,) = [requirement for requirement in extras["docs"] if requirement.startswith("pymoo_gridpath[")]
    assert "fast" in package.partition("[")[2].rstrip("]").split(","), "plain Python takes many times the ten minutes"
