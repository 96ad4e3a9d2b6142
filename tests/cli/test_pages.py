"""Pages to choose from, as the command line writes them."""

import contextlib
import io

import pytest
from command_lines import FAST, run

from pymoo_gridpath.cli import main


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """A plan with its page."""
    folder = tmp_path_factory.mktemp("planned")
    done = run("plan", "office", *FAST, "-o", folder / "out", "--html", folder / "front.html", "--show")
    assert done.returncode == 0, done.stderr
    return folder, done


def test_plan_writes_a_page(planned):
    folder, done = planned
    assert done.stdout.splitlines()[-1] == f"page: {folder / 'front.html'}"
    page = (folder / "front.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>") and "<title>office</title>" in page
    assert not set(done.stdout) & set("\u2580\u2584\u2588"), "no terminal, no map"


def test_explore_makes_the_same_page_of_the_stored_paths(planned, tmp_path):
    folder, _ = planned
    done = run("explore", folder / "out" / "paths.json", "--show")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"page: {folder / 'out' / 'paths.html'}\n"
    assert (folder / "out" / "paths.html").read_bytes() == (folder / "front.html").read_bytes()
    done = run("explore", folder / "out" / "paths.json", "-o", tmp_path / "mine.html", "--title", "<Mine>")
    assert done.returncode == 0 and "<title>&lt;Mine&gt;</title>" in (tmp_path / "mine.html").read_text(encoding="utf-8")


def test_explore_refuses_what_is_no_set_of_paths(tmp_path, free_map):
    done = run("explore", free_map)
    assert done.returncode == 2 and "the file is not JSON" in done.stderr and done.stderr.count("\n") == 1
    done = run("explore", tmp_path / "none.json")
    assert done.returncode == 2 and "cannot be read" in done.stderr


@pytest.mark.parametrize("place", ["", ".", "no/such/folder/front.html"])
def test_a_page_that_cannot_be_written_is_refused_before_the_search(place):
    with pytest.raises(SystemExit) as ended, contextlib.redirect_stderr(io.StringIO()) as err:
        main(["plan", "--html", place])
    assert ended.value.code == 2 and "is not a file in a folder that exists" in err.getvalue()
