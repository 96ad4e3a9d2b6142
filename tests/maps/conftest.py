"""Hand-made files for the readers, and the one way in which readers may refuse a file."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import pytest

from pymoo_gridpath.errors import MapError, visible

SHARED_DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real maps, which is not part of the repository."""
    if not SHARED_DATA.is_dir():
        pytest.skip("real maps are tested only where the folder ../shared/data lies beside the repository")
    return SHARED_DATA


@pytest.fixture
def write(tmp_path):
    """Write text or bytes to a file and return its path."""

    def write(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


@pytest.fixture
def refused():
    """Check that a call raises one MapError: one line that names the file, the line, what was found and what was expected."""

    def refused(call, path, line, *words, **options) -> MapError:
        with pytest.raises(MapError) as caught:
            call(path, **options)
        error, message = caught.value, str(caught.value)
        where = visible(path) if line is None else f"{visible(path)}, line {line}"
        assert message.startswith(f"{where}: ") and error.line == line
        assert "\n" not in message and "expected" in message
        for word in words:
            assert str(word) in message
        return error

    return refused


def png_bytes(
    width: int, height: int, depth: int, colour: int, rows: list[bytes], *chunks: tuple[bytes, bytes], interlaced: int = 0
) -> bytes:
    """Build a PNG by hand; colour type 0 is grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced)
    body = zlib.compress(b"".join(b"\0" + row for row in rows))
    parts = [(b"IHDR", header), *chunks, (b"IDAT", body), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)


@pytest.fixture
def png():
    return png_bytes
