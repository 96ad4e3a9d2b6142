"""The README's Python runs as it stands."""

import re
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"


def test_its_python_runs_from_top_to_bottom(tmp_path, monkeypatch, capsys):
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)
    program, *rest = blocks
    assert 15 <= len([line for line in program.splitlines() if line.strip()]) <= 35, "an example that fits on a screen"
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(program, str(README), "exec"), names)
    out = capsys.readouterr().out
    assert "shortest" in out and "NOT FEASIBLE" not in out
    assert len(names["paths"]) > 20, "a front that shows what a trade-off is"
    assert (tmp_path / "paths.json").exists() and (tmp_path / "figures" / "map.png").exists()
    for block in rest:
        exec(compile(block, str(README), "exec"), names)
    found = r"\d+ points on the true front, of which the search found \d+%\nand [01]\.\d+ of its hypervolume"
    assert re.search(found, capsys.readouterr().out)
