"""Study files of any size, and messages about what stands in them, whatever that is."""

from __future__ import annotations

import copy
import tomllib

import pytest

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.specification import toml_file
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.study.specification.toml_file import load_study
from pymoo_gridpath.study.specification.toml_lines import KeyLines

PLAIN = """\
seeds = 1
budget = { generations = 2 }
[[problems]]
random = { size = 6, p0 = 0.1, seeds = 1 }
[[algorithms]]
algorithm = "NSGA2"
pop_size = 8
"""

STRANGE = {"long": "a" * 5000, "raw": "\x1b[31m\x00" * 30, "split": "a\nb", "hidden": "\u202e\U0001f600" * 200}


def is_sentence(text: str) -> bool:
    return text.isprintable() and 0 < len(text) <= 600


@pytest.mark.parametrize("strange", STRANGE.values(), ids=STRANGE)
@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ((), "@", 1),
        (("budget",), "@", 1),
        (("problems", 0), "@", 1),
        (("problems", 0, "random"), "@", 1),
        (("problems", 0), "objectives", ["@"]),
        (("problems", 0), "objectives", ["length", "@", "@"]),
        (("problems", 0), "representation", "@"),
        (("algorithms", 0), "@", 1),
        (("algorithms", 0), "algorithm", "@"),
        (("algorithms", 0), "operators", "@"),
        (("algorithms", 0), "operators", {"mutation": "@"}),
        (("algorithms", 0), "operators", {"@": "PathMutation"}),
        (("algorithms", 0), "operators", {"mutation": {"class": "PathMutation", "@": 1}}),
        (("algorithms", 0), "parameters", {"@": 1}),
        (("algorithms", 0), "parameters", {"n_offsprings": "@"}),
    ],
)
def test_names_and_keys_of_any_length_and_letters_are_shown_on_one_short_line(table, key, value, strange):
    def filled(item):
        if isinstance(item, dict):
            return {filled(k): filled(v) for k, v in item.items()}
        return [filled(v) for v in item] if isinstance(item, list) else strange if item == "@" else item

    data = copy.deepcopy(tomllib.loads(PLAIN))
    inner = data
    for part in table:
        inner = inner[part]
    inner[filled(key)] = filled(value)
    with pytest.raises(StudyError) as error:
        Study.from_dict(data)
    assert is_sentence(str(error.value)), str(error.value)


@pytest.mark.parametrize("key", ["map", "scen"])
@pytest.mark.parametrize("name", ["a" * 5000, "a" * 300, "a" * 300 + ".map", "a\u202eb"])
def test_maps_whose_names_no_file_can_have_are_refused(tmp_path, key, name):
    data = tomllib.loads(PLAIN) | {"problems": [{"map": "paper16"} | {key: name}]}
    with pytest.raises(StudyError) as error:
        plan_study(Study.from_dict(data, folder=tmp_path))
    assert is_sentence(str(error.value)), str(error.value)


def test_files_of_up_to_two_megabytes_are_read(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(PLAIN.ljust(2_000_000, "#"))
    assert load_study(file).seeds == (1,)
    file.write_text(PLAIN.ljust(2_000_001, "#"))
    with pytest.raises(StudyError, match=r"larger than 2,000,000 bytes, expected a study"):
        load_study(file)


@pytest.mark.parametrize("part", ["a", '"b c"', "'d'", "e-1"])
@pytest.mark.parametrize("joint", [".", " . "])
def test_keys_of_more_than_fifty_parts_are_refused_with_their_line(tmp_path, part, joint, monkeypatch):
    file = tmp_path / "study.toml"
    for written in (f"{joint.join([part] * 51)} = 1\n", f"[{joint.join([part] * 1000)}]\n"):
        file.write_text(PLAIN + "\n" + written)
        with monkeypatch.context() as patched, pytest.raises(StudyError, match="a key has more than 50 parts") as error:
            # It would take time that grows with the square of the parts.
            patched.setattr(toml_file.tomllib, "loads", None)
            load_study(file)
        assert error.value.line == 9
    file.write_text(PLAIN + f"{joint.join([part] * 50)} = 1\n")
    with pytest.raises(StudyError, match="has no key"):
        load_study(file)


def test_lines_are_counted_once():
    class Watched(str):
        __slots__ = ()
        looked_at = 0

        def count(self, letters, start=0, end=None):
            Watched.looked_at += (len(self) if end is None else end) - start
            return super().count(letters, start, len(self) if end is None else end)

    rows = [f"k{k} = {k}" for k in range(2000)]
    text = Watched("\n".join(rows))
    lines = KeyLines(text)
    assert [lines.line((f"k{k}",)) for k in range(2000)] == list(range(1, 2001))
    assert Watched.looked_at <= len(text)
