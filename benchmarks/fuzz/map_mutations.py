"""Ways to damage a map for the fuzzer, and what must become of each: "same", "other", "refused", or "" where anything may."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable

import numpy as np
from map_files import Written, chunks

Mutation = Callable[[bytes, np.random.Generator], bytes]

_NUMBERS = [
    b"0",
    b"-1",
    b"1e309",
    b"nan",
    b"9" * 30,
    b"9" * 5000,
    b"2147483648",
    b"18446744073709551616",
    b"0x10",
    b"1_0",
    b"\xd9\xa1",
]
_TOKENS = [
    b"#",
    b":",
    b"\0",
    b"\xff",
    b"\x1b[31m",
    b" ",
    b"\t",
    b"\n",
    b"\r",
    b"\xe2\x80\xae",
    b"type octile",
    b"version 1",
    b"image: ",
]


def _place(data: bytes, rng) -> int:
    # Headers break in more ways than cells.
    return int(rng.integers(0, max(min(len(data), 64), 1) if rng.random() < 0.5 else max(len(data), 1)))


def flip_bits(data, rng):
    changed = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        if changed:
            changed[_place(data, rng)] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def any_bytes(data, rng):
    at = _place(data, rng)
    new = rng.bytes(int(rng.integers(1, 9)))
    return data[:at] + new + data[at + len(new) :]


def cut(data, rng):
    return data[: _place(data, rng)]


def drop(data, rng):
    at = _place(data, rng)
    return data[:at] + data[at + int(rng.integers(1, 40)) :]


def insert(data, rng):
    at = _place(data, rng)
    return data[:at] + _TOKENS[rng.integers(len(_TOKENS))] * int(rng.choice([1, 3, 300])) + data[at:]


def repeat(data, rng):
    at = _place(data, rng)
    part = data[at : at + int(rng.integers(1, 60))]
    return data[:at] + part * int(rng.choice([2, 3, 2000])) + data[at + len(part) :]


def append(data, rng):
    return data + rng.bytes(int(rng.integers(1, 100)))


def swap_tokens(data, rng):
    parts = re.split(rb"(\s+)", data)
    a, b = rng.integers(0, len(parts), 2)
    parts[a], parts[b] = parts[b], parts[a]
    return b"".join(parts)


def repeat_line(data, rng):
    lines = data.split(b"\n")
    at = int(rng.integers(len(lines)))
    return b"\n".join([*lines[: at + 1], *lines[at:]])


def shuffle_lines(data, rng):
    lines = data.split(b"\n")
    return b"\n".join(lines[k] for k in rng.permutation(len(lines)))


def number(data, rng):
    found = list(re.finditer(rb"-?\d+(\.\d+)?", data))
    if not found:
        return data + _NUMBERS[rng.integers(len(_NUMBERS))]
    match = found[min(int(rng.integers(len(found))), int(rng.integers(1, 9)) - 1)]
    return data[: match.start()] + _NUMBERS[rng.integers(len(_NUMBERS))] + data[match.end() :]


def encoding(data, rng):
    text = data.decode("latin-1")
    return text.encode(str(rng.choice(["utf-16", "utf-32", "utf-8-sig", "utf-7", "cp037"])))


def empty_lines(data, rng):
    return b"\n" * int(rng.choice([1, 1000, 2_000_000])) + data


def long_line(data, rng):
    at = data.find(b"\n") + 1
    return data[:at] + rng.choice([b".", b"#", b"a ", b"[", b"1,", b": "]) * int(rng.choice([2000, 300_000])) + data[at:]


def nested(data, rng):
    pieces = [
        b"[" * 5000,
        b"{a: " * 3000,
        b"x: &a [*a]\n",
        b"- " * 3000,
        b"? " * 2000,
        b"!!python/object:os.system {}\n",
        b"x: !!binary ab\n",
    ]
    return data + b"more: " * int(rng.integers(2)) + pieces[rng.integers(len(pieces))]


def anchors(data, rng):
    lines = [b"a0: &a0 [1, 2]"] + [b"a%d: &a%d [%s]" % (k, k, b", ".join([b"*a%d" % (k - 1)] * 9)) for k in range(1, 8)]
    merge = b"b: &b {c: 1}\nd: {<<: [*b, *b]}\n<<: *b"
    return data + (merge if rng.random() < 0.5 else b"\n".join(lines)) + b"\n"


def png_chunks(data, rng):
    """Drop, double, move, fill or rewrite a chunk, with a right checksum."""
    found = chunks(data)
    if not data.startswith(b"\x89PNG") or not found:
        return flip_bits(data, rng)
    at = int(rng.integers(len(found)))
    kind, content = found[at]
    if rng.random() < 0.3:
        found.pop(at)
    elif rng.random() < 0.3:
        found.insert(int(rng.integers(len(found))), found[at])
    elif rng.random() < 0.4:
        new = [
            (b"tRNS", b"\0\7"),
            (b"PLTE", bytes(9)),
            (b"eXIf", rng.bytes(40)),
            (b"tEXt", b"k\0" + b"x" * 90_000),
            (b"acTL", bytes(8)),
        ]
        found.insert(1, new[rng.integers(len(new))])
    elif kind == b"IDAT" and rng.random() < 0.5:
        try:
            found[at] = kind, zlib.compress(any_bytes(zlib.decompress(content), rng))
        except zlib.error:
            found[at] = kind, b""
    else:
        found[at] = kind, any_bytes(content, rng)
    parts = (struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in found)
    return data[:8] + b"".join(parts)


def image_size(data, rng):
    """Declare another size where the format has it."""
    sizes = [0, 1, 2, 255, 3000, 9999, 65535, 2**31 - 1, 2**32 - 1]
    value = sizes[rng.integers(len(sizes))]
    changed = bytearray(data)
    wide = (16, 20, ">I") if data[:1] == b"\x89" else (18, 22, "<I") if data[:2] == b"BM" else (6, 8, "<H")
    at = wide[rng.integers(2)]
    if len(data) > at + 4:
        struct.pack_into(wide[2], changed, at, value % (2**16 if wide[2] == "<H" else 2**32))
    if data[:4] == b"\x89PNG":
        struct.pack_into(">I", changed, 29, zlib.crc32(changed[12:29]))
    return bytes(changed)


def tiff_tag(data, rng):
    """Change the number, kind, count or value of one tag of a TIFF."""
    if data[:4] != b"II*\0":
        return flip_bits(data, rng)
    changed = bytearray(data)
    (start,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, start)
    at = start + 2 + 12 * int(rng.integers(count))
    offset, form = [(0, "<H"), (2, "<H"), (4, "<I"), (8, "<I")][rng.integers(4)]
    values = [0, 1, 2, 3, 5, 8, 9, 278, 322, 4096, 65535, 8_781_830, 2**31, 2**32 - 1]
    struct.pack_into(form, changed, at + offset, values[rng.integers(len(values))] % (2**16 if form == "<H" else 2**32))
    return bytes(changed)


def npy_header(data, rng):
    """Write another header before the data, of the right length."""
    shapes = [
        "(9999, 9999)",
        "(3, 3, 3)",
        "(-1, 4)",
        "(2,)",
        "()",
        "(10**9, 2)",
        "(" + "9" * 3000 + ", 1)",
        "(True, 2)",
        "(2.0, 2)",
        "(" * 90,
    ]
    kinds = [
        "'|O'",
        "'<U9'",
        "'<f8'",
        "'<c16'",
        "[('a', '<i4')]",
        "'|V99999999'",
        "'<M8[s]'",
        "'|b1'",
        "7",
        "'<f16'",
        "'" + "x" * 5000 + "'",
    ]
    kind, shape = kinds[rng.integers(len(kinds))], shapes[rng.integers(len(shapes))]
    header = f"{{'descr': {kind}, 'fortran_order': {['False', 'True', '2'][rng.integers(3)]}, 'shape': {shape}}}"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header) + 1) + header.encode() + b"\n" + data[80:]


ANYTHING: list[Mutation] = [
    flip_bits,
    any_bytes,
    cut,
    drop,
    insert,
    repeat,
    append,
    swap_tokens,
    repeat_line,
    shuffle_lines,
    number,
    encoding,
]
TEXTS: list[Mutation] = [empty_lines, long_line, number, repeat_line, swap_tokens]
OF_FORMAT: dict[str, list[Mutation]] = {
    "text": TEXTS,
    "matrix": TEXTS,
    "MovingAI": TEXTS,
    "scen": TEXTS,
    "npy": [npy_header],
    "YAML": [*TEXTS, nested, anchors],
    "EXIF": [png_chunks, tiff_tag],
    "GDAL": [tiff_tag],
    "geotiff": [tiff_tag],
    "png": [png_chunks, image_size],
    "tif": [tiff_tag],
    "gif": [image_size],
    "bmp": [image_size],
}
_SUFFIXES = ["map", "yaml", "npy", "png", "tif", "gif", "txt", "scen", "pgm", "webp", "jpg", "", "3dmap"]


def mutate(written: Written, rng: np.random.Generator) -> tuple[str, dict[str, bytes], str]:
    """Return what was done to a map, its files afterwards, and what must become of it."""
    name, content = next(iter(written.files.items()))
    others = {k: v for k, v in written.files.items() if k != name}
    choice = rng.random()
    whole = "refused" if written.format == "scen" else "same"
    if choice < 0.08:
        return "untouched", {name: content, **others}, whole
    if choice < 0.2:
        return _harmless(written, name, content, others, rng, whole)
    if choice < 0.3 and written.format != "scen":
        return _telling(written, name, content, others, rng)
    if choice < 0.36:
        suffix = _SUFFIXES[rng.integers(len(_SUFFIXES))]
        return "other suffix", {f"m2.{suffix}": content, **others}, ""
    if others and choice < 0.5:
        (other, data), *_ = others.items()
        mutation = ANYTHING[rng.integers(len(ANYTHING))]
        return f"image: {mutation.__name__}", {name: content, other: mutation(data, rng)}, ""
    own = OF_FORMAT.get(written.format.split()[0], [])
    some = own if own and rng.random() < 0.5 else ANYTHING
    mutation = some[rng.integers(len(some))]
    content = mutation(content, rng)
    for _ in range(rng.choice([0, 1, 2], p=[0.7, 0.2, 0.1])):
        content = ANYTHING[rng.integers(len(ANYTHING))](content, rng)
    return mutation.__name__, {name: content, **others}, ""


def _harmless(written, name, content, others, rng, whole):
    """What must not matter."""
    if written.format in ("YAML", "message"):
        ways = {
            "line ends": content.replace(b"\n", b"\r\n"),
            "a comment": b"# a map\n" + content,
            "mark": b"\xef\xbb\xbf" + content,
        }
    elif written.format in ("text", "matrix", "MovingAI", "scen"):
        ways = {
            "line ends": content.replace(b"\n", b"\r\n"),
            "old line ends": content.replace(b"\n", b"\r"),
            "blanks at line ends": content.replace(b"\n", b" \t\n"),
            "empty lines at the end": content + b"\n \n\n",
            "mark": b"\xef\xbb\xbf" + content,
        }
    elif written.format in ("bag", "mcap"):
        # What stands behind is read as another record.
        ways = {"nothing": content}
    elif name.endswith(".png"):
        ways = {"a text chunk": content[:33] + b"\0\0\0\3tEXta\0b" + struct.pack(">I", zlib.crc32(b"tEXta\0b")) + content[33:]}
    else:
        ways = {"bytes behind": content + b"\0"}
    way = list(ways)[rng.integers(len(ways))]
    return f"harmless: {way}", {name: ways[way], **others}, whole


def _telling(written, name, content, others, rng):
    """What must matter."""
    if written.format == "YAML":
        line = content.split(b"\n")[rng.integers(6)]
        ways = {
            "a key twice": (content + line + b"\n", "refused"),
            "a key missing": (content.replace(line + b"\n", b""), "refused"),
            "negate": (content.replace(b"negate: 0", b"negate: 1"), "other"),
        }
    elif written.format in ("text", "MovingAI"):
        # The row at the end, which is longer than any header line's last word is short.
        ways = {
            "a letter more": (
                content[:-1] + content[-2:],
                "refused" if written.occupied.shape[0] > 1 or name == "m.map" else "other",
            ),
            "an unknown letter": (content[:-2] + b"?\n", "refused"),
            "another last cell": (content[:-2] + (b"." if written.occupied[0, -1] else b"@") + b"\n", "other"),
        }
    elif written.format == "matrix":
        ways = {
            "a number more": (content[:-1] + b" 0\n", "refused"),
            "another number": (b"7" + content[1:], "refused"),
            "a row less": (content[content.index(b"\n") + 1 :], "other"),
        }
    elif written.format == "npy":
        ways = {"cut short": (content[:-1], "refused")}
    elif name.endswith((".png", ".webp", ".bmp")):
        ways = {"half of it": (content[: len(content) // 2], "refused")}
    elif written.format == "tif L":
        ways = {"more rows declared": (_more_rows(content), "refused")}
    else:
        ways = {"nothing": (b"", "refused")}
    if name.endswith(".png"):
        ways["pixels end early"] = _pixels_end_early(content)
    way = list(ways)[rng.integers(len(ways))]
    return f"telling: {way}", {name: ways[way][0], **others}, ways[way][1]


def _pixels_end_early(content: bytes) -> tuple[bytes, str]:
    """Leave out the last row of a PNG, in a stream that is whole."""
    (height,) = struct.unpack_from(">I", content, 20)
    pixels = zlib.decompress(b"".join(c for k, c in chunks(content) if k == b"IDAT"))
    short = zlib.compress(pixels[: -(len(pixels) // height)])
    parts = [(k, short if k == b"IDAT" else c) for k, c in chunks(content)]
    return content[:8] + b"".join(
        struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in parts
    ), "refused"


def _more_rows(content: bytes) -> bytes:
    """Declare 50 rows, of which the strips that are listed hold the few that there were."""
    (start,) = struct.unpack_from("<I", content, 4)
    (count,) = struct.unpack_from("<H", content, start)
    entries = range(start + 2, start + 2 + 12 * count, 12)
    place = {struct.unpack_from("<H", content, at)[0]: at for at in entries}
    changed = bytearray(content)
    (rows,) = struct.unpack_from("<H", content, place[257] + 8)
    struct.pack_into("<HHII", changed, place[257], 257, 4, 1, 50)
    struct.pack_into("<HHII", changed, place[278], 278, 4, 1, rows)
    return bytes(changed)
