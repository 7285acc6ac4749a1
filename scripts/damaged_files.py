"""Damages files as transfers, other programs and attackers do, for scripts/campaign.py."""

import io
import random
import re
import struct
import zipfile
import zlib

# Text that messages must not repeat at length.
SECRET = "".join(random.Random(0).choices("bcdfghjklmnpqrstvwxz", k=5000))
NUMBERS = ["-1", "0", "1e-320", "4294967295", "2147483648", "-9223372036854775809", "18446744073709551616", "1e308", "-1e38",
           "3.5e38", "1e999", "nan", "-inf", "1e30", "0x7fffffff", "0.5", "2", "7", "100", "1" * 400, "1e-45"]
WORDS = [SECRET, "\x1b[2J\x1b]0;x\x07", "\u202egnp.exe\u202c\u2066", "\0\0\0\0", "\r\n", "\x9b31m", "\xff\xfe", "\u2028", "",
         "../" * 40 + "etc/passwd", "%s%n" * 9, "'\"><script>", "=cmd|' /C calc'!A0", "a" * 70_000, "a b " * 300]
BYTES = [b"\xff" * 8, b"\0" * 8, *(struct.pack("<q", 1 << n) for n in (16, 31, 40, 62)), struct.pack(">I", 1 << 31),
         *(struct.pack("<f", n) for n in (1e38, 1e-40, float("nan"))), struct.pack("<d", 1e308), struct.pack("<d", float("-inf"))]


def part_of(data, at, longest):
    begin = at.randrange(len(data))
    return begin, begin + at.randrange(1, 2 + min(longest, len(data) // 8))


def flip_bits(data, at):
    out = bytearray(data)
    for _ in range(at.choice([1, 2, 8])):
        out[at.randrange(len(out))] ^= 1 << at.randrange(8)
    return bytes(out)


def cut_short(data, at):
    return data[:at.randrange(len(data))]


def insert_bytes(data, at):
    begin = at.randrange(len(data))
    return data[:begin] + at.choice([at.randbytes(at.randrange(1, 40)), *BYTES]) + data[begin:]


def repeat_bytes(data, at):
    """Takes bytes out, or repeats them."""
    begin, end = part_of(data, at, 400)
    return data[:begin] + data[begin:end] * at.choice([0, 0, 2, 3, 300]) + data[end:]


def swap_parts(data, at):
    (a, b), (c, d) = sorted((part_of(data, at, 400), part_of(data, at, 400)))
    return data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def replace_bytes(data, at):
    value, begin = at.choice(BYTES), at.randrange(min(len(data), at.choice([200, 1 << 30]))) & ~at.choice([0, 3])
    return data[:begin] + value + data[begin + len(value):]


def replace_text(pattern, words):
    def damage(data, at):
        found = at.choice(list(re.finditer(pattern, data)) or [None])
        return data[:found.start()] + at.choice(words).encode() + data[found.end():] if found else flip_bits(data, at)
    return damage


def damage_inside(data, at):
    """Damages a member of a zip, or what zlib packed, and packs it again."""
    damage = at.choice(DAMAGES)
    try:
        whole, out = zipfile.ZipFile(io.BytesIO(data)), io.BytesIO()
        members = {name: whole.read(name) for name in whole.namelist()}
        chosen = at.choice(list(members))
        members[chosen] = damage(members[chosen] or b"0", at)
        with zipfile.ZipFile(out, "w", at.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])) as packed:
            for name, member in members.items():
                packed.writestr(zipfile.ZipInfo(name), member)
        return out.getvalue()
    except Exception:  # It is no zip, or a damaged one, for which zipfile raises many kinds.
        pass
    for start in (found.start() for found in re.finditer(rb"\x1f\x8b\x08|x[\x01\x5e\x9c\xda]", data)):
        try:
            unpack, pack = zlib.decompressobj(47), zlib.compressobj(9, wbits=31 if data[start] == 0x1f else 15)
            inside = unpack.decompress(data[start:])
            return data[:start] + pack.compress(damage(inside or b"0", at)) + pack.flush() + unpack.unused_data
        except zlib.error:
            continue
    return damage(data, at)


TEXTS = [replace_text(rb"[-+]?[0-9][0-9.]*(?:[eE][-+]?[0-9]+)?", NUMBERS), replace_text(rb"[A-Za-z_]{3,}", WORDS)]
DAMAGES = [flip_bits, cut_short, insert_bytes, repeat_bytes, swap_parts, *[replace_bytes] * 2, *TEXTS * 2]


def damaged(seeds, at):
    """Returns the kind, extension and bytes of a damaged file."""
    kind = at.choices(list(seeds), [2 if kind == "points" else 7 if kind in ("mesh", "field") else 0.3 for kind in seeds])[0]
    extension = at.choice(sorted(seeds[kind]))
    data = at.choice(seeds[kind][extension])
    other = at.choice(at.choice(list(seeds[at.choice(["mesh", "field"])].values())))
    way, head = at.random(), at.randrange(300)
    if way < 0.06:  # Another format, text that is no format, a header of another format.
        return kind, extension, other if way < 0.02 else SECRET.encode() if way < 0.03 else other[:head] + data[head:]
    for _ in range(at.choice([1, 1, 1, 1, 2, 4])):
        data = at.choice([*DAMAGES, damage_inside, damage_inside])(data or b"0", at)[:300_000]
    return kind, extension, data
