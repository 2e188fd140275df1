# SPDX-License-Identifier: Zlib
"""Seeded damage to files: bytes, tokens, structure, extreme numbers. Every function takes a random generator, the bytes, and
another file's bytes to copy from."""

import re
import sqlite3
import struct
import tempfile
from pathlib import Path

NUMBERS = [b"0", b"-0", b"-0.0", b"-1", b"1", b"2", b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-320", b"1e-9", b"1e15",
           b"0.5", b"65536", b"2147483647", b"2147483648", b"-2147483649", b"4294967296", b"9223372036854775807",
           b"9223372036854775808", b"-9223372036854775809", b"18446744073709551616", b"1e400", b"0x10", b"1_000", b"07",
           b"9" * 400, b"true", b'""', b'"x"', b"[]", b"{}"]
EDGE_DOUBLES = [0.0, -0.0, -1.0, 1.0, float("nan"), float("inf"), float("-inf"), 1e308, -1e308, 1e-320, 1e9, 1e-9]
EDGE_WHOLE = [0, 1, 2, 3, -1, -2, 255, 65536, 2**31 - 1, -2**31, 2**32 - 1, 2**40, 2**63 - 1, -2**63]
TOKEN = re.compile(rb"[A-Za-z_]\w*|[-+]?[\d.][\w.]*|\s+|.", re.S)
NUMBER = re.compile(rb"(?<![\w.])-?\d[\d.eE_]*")
BRACKETS = {b"{": b"}", b"[": b"]", b"(": b")", b'"': b'"'}
DEPTHS = [2, 60, 64, 65, 300, 3000, 30000]
MOST = 1 << 20  # bytes of an input


def place(rng, data):
    """A random span, usually short."""
    at = rng.randrange(len(data) + 1)
    return at, min(len(data), at + 1 + int(rng.expovariate(0.1)))


def flip(rng, data, _):
    at = rng.randrange(len(data) or 1)
    return data[:at] + bytes([rng.randrange(256)]) + data[at + 1:]


def cut(rng, data, _):
    begin, end = place(rng, data)
    return data[:begin] + data[end:]


def cut_off(rng, data, _):
    return data[:rng.randrange(len(data) + 1)]


def repeat(rng, data, _):
    begin, end = place(rng, data)
    return data[:end] + data[begin:end] * rng.choice([1, 1, 2, 100]) + data[end:]


def borrow(rng, data, other):
    begin, end = place(rng, other)
    at, to = place(rng, data)
    return data[:at] + other[begin:end] + data[rng.choice([at, to]):]


def insert(rng, data, _):
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice([b"\0", b"\n", b"\r", b"\t", b"\x1b[31m", b"\xff", b"\xc3\xa9", b"\xe2\x80\xa8",
                                   b'"', b"'", b"\\",
                                   b"$", b"*", b"#", b"=", b","]) + data[at:]


def tokens(rng, data, other):
    """Deletes or doubles a token, or swaps it with another one or one of the other file."""
    parts, theirs = TOKEN.findall(data), TOKEN.findall(other)
    if len(parts) < 2:
        return data
    i, j = (rng.choice([k for k, p in enumerate(parts) if not p.isspace()] or [0]) for _ in range(2))
    what = rng.randrange(4)
    if what == 0:
        del parts[i]
    elif what == 1:
        parts.insert(i, parts[i] + rng.choice([b"", b" "]))
    elif what == 2:
        parts[i], parts[j] = parts[j], parts[i]
    elif theirs:
        parts[i] = rng.choice(theirs)
    return b"".join(parts)


def number(rng, data, _):
    found = list(NUMBER.finditer(data))
    if not found:
        return data
    m = rng.choice(found)
    return data[:m.start()] + rng.choice(NUMBERS) + data[m.end():]


def name(rng, data, _):
    """Replaces a number with a name from the same file: `it = "$it"`."""
    names = re.findall(rb"\$?[A-Za-z_]\w*", data)
    found = list(NUMBER.finditer(data))
    if not found or not names:
        return data
    m, n = rng.choice(found), rng.choice(names)
    return data[:m.start()] + rng.choice([n, b'"' + n + b'"', b'"$' + n + b'"', b'"1 / ' + n + b'"']) + data[m.end():]


def lines(rng, data, other):
    """Drops, doubles or moves lines or blocks, or copies them from the other file."""
    parts, theirs = data.split(b"\n"), other.split(b"\n")
    i, j = rng.randrange(len(parts)), rng.randrange(len(parts))
    n = rng.choice([1, 1, 2, 5])
    block = parts[i:i + n]
    what = rng.randrange(4)
    if what == 0:
        del parts[i:i + n]
    elif what == 1:
        parts[j:j] = block * rng.choice([1, 1, 3, 200])
    elif what == 2:
        del parts[i:i + n]
        parts[j:j] = block
    else:
        k = rng.randrange(len(theirs))
        parts[j:j] = theirs[k:k + n]
    return b"\n".join(parts)


def nest(rng, data, _):
    """Nests a bracket in itself: sometimes deeply, rarely very deeply."""
    found = [i for i in range(len(data)) if data[i:i + 1] in BRACKETS]
    depth = rng.choice(DEPTHS)
    if not found:
        return b"(" * depth + data + b")" * rng.choice([0, depth])
    at = rng.choice(found)
    begin = max(data.rfind(c, 0, at) for c in (b"\n", b",", b" ", b"{", b"[", b":")) + 1
    opening = data[begin:at + 1] if len(data[begin:at + 1]) < 30 else data[at:at + 1]
    closing = BRACKETS[data[at:at + 1]]
    return data[:begin] + opening * depth + data[begin:at + 1] + closing * rng.choice([0, depth]) + data[at + 1:]


def overwrite(rng, data, _):
    """Overwrites a number of a binary file with an extreme value."""
    kind = rng.choice(["<d", "<d", "<f", "<i", "<q", "<B"])
    if kind in ("<d", "<f"):
        value = rng.choice(EDGE_DOUBLES)
        packed = struct.pack(kind, value if kind == "<d" or abs(value) < 1e38 else float("inf"))
    else:
        value = rng.choice(EDGE_WHOLE)
        size = struct.calcsize(kind)
        packed = (value % (1 << (8 * size))).to_bytes(size, "little")
    at = rng.randrange(max(1, len(data) - len(packed) + 1))
    return data[:at] + packed + data[at + len(packed):]


def database(rng, data, other):
    """Changes one thing in a store, which is still a database."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.db"
        path.write_bytes(data)
        db = sqlite3.connect(path, isolation_level=None)
        db.text_factory = lambda text: text.decode("latin-1")
        try:
            tables = [row[0] for row in db.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
            table = rng.choice(tables)
            columns = [row[1] for row in db.execute(f"PRAGMA table_info('{table}')")]
            column = rng.choice(columns)
            rows = db.execute(f"SELECT rowid, \"{column}\" FROM \"{table}\"").fetchall()
            what = rng.randrange(10)
            if what == 0:
                db.execute(f"DROP TABLE \"{table}\"")
            elif what == 1:
                db.execute(f"ALTER TABLE \"{table}\" RENAME COLUMN \"{column}\" TO x")
            elif what == 2:
                db.execute(f"DELETE FROM \"{table}\"")
            elif what == 3:
                schema = rng.choice([0, 1, 2, 4, 2147483647, -1, "", "x", None])
                db.execute("UPDATE meta SET value = ? WHERE key = 'schema_version'", (schema,))
            elif rows:
                row, value = rng.choice(rows)
                old = value if isinstance(value, bytes) else str(value).encode("latin-1", "replace")
                new = rng.choice([None, -1, 2**63 - 1, 1e308, float("inf"), "", "x", b"\0\xff", "{}", "[" * 3000,
                                  text(rng, old, other)])
                if isinstance(value, str) and isinstance(new, bytes):
                    new = new.decode("utf-8", "replace")
                db.execute(f"UPDATE \"{table}\" SET \"{column}\" = ? WHERE rowid = ?", (new, row))
        except (sqlite3.Error, IndexError, UnicodeDecodeError):
            pass  # SQLite refuses the change, or the table is gone
        db.close()
        return path.read_bytes()


def several(*ways):
    """Applies one of these, and more with decreasing probability."""
    def mutate(rng, data, other):
        while True:
            data = rng.choice(ways)(rng, data, other)[:MOST]
            if rng.random() < 0.6:
                return data
    return mutate


text = several(tokens, tokens, tokens, number, number, number, name, lines, lines, nest, flip, cut, cut_off, repeat, borrow,
               insert)
binary = several(overwrite, overwrite, overwrite, flip, cut, cut_off, repeat, borrow)
