// Arrays out of the page: base64, then a zlib stream (RFC 1950, RFC 1951). Written out, because the browser's own
// decompression is asynchronous and the page has to be ready when it has loaded.
"use strict";

const KINDS = { u1: Uint8Array, i2: Int16Array, u4: Uint32Array };

/** Return the typed array that `{kind, bytes, data}` of the page's data holds; little-endian, as typed arrays are nearly everywhere. */
function unpack(array) {
  const text = atob(array.data);
  const packed = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) packed[k] = text.charCodeAt(k);
  return new KINDS[array.kind](inflate(packed, array.bytes).buffer);
}

/** Return the code of a Huffman tree given by the length of each symbol's code. */
function huffman(lengths) {
  const count = new Uint16Array(16);
  for (const length of lengths) count[length]++;
  count[0] = 0;
  const next = new Uint16Array(16);
  for (let k = 1; k < 15; k++) next[k + 1] = next[k] + count[k];
  const symbols = new Uint16Array(lengths.length);
  lengths.forEach((length, symbol) => {
    if (length) symbols[next[length]++] = symbol;
  });
  return { count, symbols };
}

const LENGTH_BASE = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];
const BACK_BASE = [
  1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289,
  16385, 24577,
];
const CODES_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/** Return the `size` bytes of a zlib stream. */
function inflate(source, size) {
  const out = new Uint8Array(size);
  let at = 2; // after the header
  let end = 0;
  let hold = 0;
  let held = 0;

  function bits(need) {
    while (held < need) {
      hold |= source[at++] << held;
      held += 8;
    }
    const value = hold & ((1 << need) - 1);
    hold >>>= need;
    held -= need;
    return value;
  }

  function symbol(code) {
    let value = 0;
    let first = 0;
    let index = 0;
    for (let length = 1; length < 16; length++) {
      value |= bits(1);
      const count = code.count[length];
      if (value - first < count) return code.symbols[index + value - first];
      index += count;
      first = (first + count) << 1;
      value <<= 1;
    }
    throw new Error("the data of this page are damaged");
  }

  function trees() {
    const sizes = [bits(5) + 257, bits(5) + 1];
    const lengths = new Array(19).fill(0);
    const n = bits(4) + 4;
    for (let k = 0; k < n; k++) lengths[CODES_ORDER[k]] = bits(3);
    const code = huffman(lengths);
    const found = [];
    while (found.length < sizes[0] + sizes[1]) {
      const what = symbol(code);
      if (what < 16) found.push(what);
      else if (what === 16) found.push(...new Array(bits(2) + 3).fill(found.at(-1)));
      else found.push(...new Array(what === 17 ? bits(3) + 3 : bits(7) + 11).fill(0));
    }
    return [huffman(found.slice(0, sizes[0])), huffman(found.slice(sizes[0]))];
  }

  function fixedTrees() {
    const lengths = Array.from({ length: 288 }, (_, k) => (k < 144 ? 8 : k < 256 ? 9 : k < 280 ? 7 : 8));
    return [huffman(lengths), huffman(new Array(30).fill(5))];
  }

  for (let last = 0; !last; ) {
    last = bits(1);
    const kind = bits(2);
    if (kind === 0) {
      hold = held = 0;
      const n = source[at] | (source[at + 1] << 8);
      out.set(source.subarray(at + 4, at + 4 + n), end);
      at += 4 + n;
      end += n;
      continue;
    }
    const [literals, distances] = kind === 1 ? fixedTrees() : trees();
    for (let what = symbol(literals); what !== 256; what = symbol(literals)) {
      if (what < 256) {
        out[end++] = what;
        continue;
      }
      const n = LENGTH_BASE[what - 257] + bits(LENGTH_BITS[what - 257]);
      const far = symbol(distances);
      const back = BACK_BASE[far] + bits(far < 2 ? 0 : (far >> 1) - 1);
      for (let k = 0; k < n; k++, end++) out[end] = out[end - back];
    }
  }
  return out;
}
