"""The README's Python runs as it stands."""

import re
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"


def test_the_long_example_runs(tmp_path, monkeypatch, capsys):
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)
    (program,) = [block for block in blocks if "load_map" in block]
    assert 15 <= len([line for line in program.splitlines() if line.strip()]) <= 35, "an example that fits on a screen"
    monkeypatch.chdir(tmp_path)
    exec(compile(program, str(README), "exec"), {})
    out = capsys.readouterr().out
    assert "shortest" in out and "NOT FEASIBLE" not in out
    assert (tmp_path / "paths.json").exists() and (tmp_path / "figures" / "map.png").exists()
