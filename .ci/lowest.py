"""Print the lowest version of everything that pyproject.toml declares, as a file of constraints for pip.

    python .ci/lowest.py > pins.txt
    pip install --editable '.[test]' --constraint pins.txt

Requirements of requirements are not pinned. It runs with the lowest Python that is declared only: the packages of that
time have no wheels for those of today.
"""

import re
import sys
import tomllib
from pathlib import Path

_FORM = re.compile(r"(?P<name>[\w.-]+)(\[[\w.,-]+\])?>=(?P<lowest>[\w.]+)(,[^;]*)?(?P<marker>;.*)?")


def lowest(requirement: str) -> str:
    """Return the constraint that pins a requirement to its lowest version."""
    form = _FORM.fullmatch(requirement)
    if form is None:
        raise SystemExit(f"pyproject.toml: {requirement!r} has no lowest version, expected a form like 'numpy>=1.26'")
    return f"{form['name']}=={form['lowest']}{form['marker'] or ''}"


def pins(project: dict) -> list[str]:
    """Return the constraints of a project table: its dependencies and those of all its extras."""
    requirements = [*project["dependencies"], *(line for extra in project["optional-dependencies"].values() for line in extra)]
    # A project's extras may name each other.
    return sorted({lowest(line) for line in requirements if not line.startswith(f"{project['name']}[")})


def main() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    python = project["requires-python"].removeprefix(">=")
    if sys.version_info[:2] != tuple(map(int, python.split("."))):
        found = ".".join(map(str, sys.version_info[:2]))
        raise SystemExit(
            f"lowest versions are tested with Python {python}, not {found}: say which it is by PYTHON=python{python}"
        )
    print("\n".join(pins(project)))


if __name__ == "__main__":
    main()
