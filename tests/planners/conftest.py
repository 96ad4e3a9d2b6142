"""What is tested only where it lies beside the repository."""

from __future__ import annotations

from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parents[3] / "shared"


@pytest.fixture(scope="session")
def companions() -> Path:
    """The folder of golden counts, which is not part of the repository."""
    if not (SHARED / "companions").is_dir():
        pytest.skip("golden counts are tested only where the folder ../shared/companions lies beside the repository")
    return SHARED / "companions"
