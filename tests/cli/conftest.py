"""A small map."""

import pytest


@pytest.fixture
def free_map(tmp_path):
    path = tmp_path / "room.txt"
    path.write_text("......\n..##..\n......\n......\n")
    return path
