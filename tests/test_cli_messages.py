"""What the command line says about maps: warnings in one line, names without control characters, what was read."""

import pickle
import warnings

import pytest

from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import MapError, MapWarning, StudyError, visible

# Clears the screen, rings, and turns the writing around.
TERMINAL = "a\x1b[2J\x07\u202eb"
SHOWN = "a\\x1b[2J\\x07\\u202eb"
ROOM = "......\n..##..\n......\n......\n"
FAST = ["--start", "0,0", "--goal", "5,3", "--pop-size", "10", "--generations", "2"]


def test_control_characters_are_shown_escaped():
    assert visible(TERMINAL + "\n") == SHOWN + "\\n"
    assert visible("Büro, 部屋 'a\\b'") == "Büro, 部屋 'a\\b'"
    assert visible("\udcff") == "\\udcff"


@pytest.mark.parametrize("command", [["info"], ["plan", *FAST]])
def test_names_of_maps_are_printed_escaped(tmp_path, capsys, command):
    path = tmp_path / "map.txt"
    path.write_text(f"name: {TERMINAL}\n{ROOM}", encoding="utf-8")
    output = [] if command[0] == "info" else ["-o", str(tmp_path / TERMINAL)]
    assert main([command[0], str(path), *command[1:], *output]) == 0
    text = "".join(capsys.readouterr())
    assert SHOWN in text
    assert all(letter.isprintable() or letter == "\n" for letter in text)


def test_names_of_files_are_printed_escaped(tmp_path, capsys):
    path = tmp_path / f"{TERMINAL}.txt"
    path.write_text("what is this?\n", encoding="utf-8")
    for arguments in (["info", str(path)], ["plan", str(path)], ["study", "check", str(path)], ["info", f"no{TERMINAL}"]):
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert SHOWN in error and error.count("\n") == 1 and error[:-1].isprintable()


def test_messages_in_python_are_escaped_and_attributes_are_not():
    for error in (MapError(TERMINAL, "m", 3), StudyError("m", path=TERMINAL, line=3)):
        assert str(error) == f"{SHOWN}, line 3: m" and error.path == TERMINAL
    for thing in (MapError(TERMINAL, "m"), MapWarning(TERMINAL, "m")):
        assert str(thing) == f"{SHOWN}: m" == str(pickle.loads(pickle.dumps(thing)))


def test_warnings_are_one_line_each(capsys, monkeypatch):
    def plan(arguments):
        for path in ("a", "a", "b\n"):
            warnings.warn(MapWarning(path, "may be meant otherwise"), stacklevel=1)
        return 0

    monkeypatch.setattr("pymoo_gridpath.cli._maps", plan)
    assert main(["maps"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert set(lines) == {f"pymoo-gridpath: warning: {path}: may be meant otherwise" for path in ("a", "b\\n")}
