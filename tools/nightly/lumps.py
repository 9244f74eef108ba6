# GPL-2.0-or-later. Lumps of .bsp files by name, how two files differ, and places where a player can be.
"""The layout is in docs/reference/bsp_format.md. Files that are no .bsp, or damaged ones, have no lumps."""

import math
import re
import struct

NAMES = ["entities", "shaders", "planes", "nodes", "leafs", "leaf surfaces", "leaf brushes", "models", "brushes",
         "brush sides", "vertices", "indexes", "fogs", "surfaces", "lightmaps", "light grid", "visibility"]
MORE = {46: ["light array"], 47: ["advertisements", "SH grid"]}  # of RBSP and FBSP, of Quake Live, by version
MAGIC = {b"IBSP": (46, 47), b"RBSP": (1,), b"FBSP": (1,)}
BLOCK = 4096  # bytes that are compared at a time
EYES, FLOOR = 26, 40  # units from the origin of a player to the eyes, and from that of an item
SEEN_FROM = re.compile(r"info_player_|team_CTF_.*(player|spawn)|(weapon|item|ammo|holdable)_")


def lumps(data):
    """Name to bytes."""
    if len(data) < 8 + 8 * len(NAMES) or data[:4] not in MAGIC:
        return {}
    version = struct.unpack_from("<i", data, 4)[0]
    names = NAMES + (MORE.get(46, []) if data[:4] != b"IBSP" else [])
    slots = [struct.unpack_from("<ii", data, 8 + 8 * i) for i in range(len(names))]
    if data[:4] == b"IBSP" and version == 47 and min((at for at, size in slots if size > 0), default=0) >= 8 + 8 * 19:
        names = NAMES + MORE[47]
        slots = [struct.unpack_from("<ii", data, 8 + 8 * i) for i in range(len(names))]
    if any(at < 0 or size < 0 or at + size > len(data) for at, size in slots):
        return {}
    found = {name: data[at:at + size] for name, (at, size) in zip(names, slots)}
    start = (max(at + size for at, size in slots) + 3) // 4 * 4
    if data[start:start + 4] == b"BSPX" and start + 8 <= len(data):
        for i in range(min(struct.unpack_from("<I", data, start + 4)[0], (len(data) - start - 8) // 32)):
            name, at, size = struct.unpack_from("<24sII", data, start + 8 + 32 * i)
            found[name.rstrip(b"\0").decode(errors="replace")] = data[at:at + size]
    return found


def different_bytes(a, b):
    """Bytes that differ, with those that only one of them has."""
    both = min(len(a), len(b))
    count = abs(len(a) - len(b))
    for at in range(0, both, BLOCK):
        left, right = a[at:min(at + BLOCK, both)], b[at:min(at + BLOCK, both)]
        if left != right:
            count += sum(x != y for x, y in zip(left, right))
    return count


def changed_lumps(before, now):
    """(name, bytes before, bytes now, bytes that differ) of lumps that are not the same."""
    old, new = lumps(before), lumps(now)
    return [(name, len(old.get(name, b"")), len(new.get(name, b"")),
             different_bytes(old.get(name, b""), new.get(name, b"")))
            for name in dict.fromkeys([*old, *new]) if old.get(name, b"") != new.get(name, b"")]


def entities(data):
    """Keys and values of each entity."""
    text = lumps(data).get("entities", b"").decode(errors="replace")
    return [dict(re.findall(r'"([^"]*)"\s*"([^"]*)"', block)) for block in re.findall(r"\{[^{}]*\}", text)]


def places(data, count):
    """[x, y, z, yaw in degrees] of so many views: places far from each other, starting with that of a player, and if there
    are fewer, other directions there."""
    found = []
    for entity in entities(data):
        name, numbers = entity.get("classname", ""), entity.get("origin", "").split()
        try:
            at = [float(number) for number in numbers]
            yaw = float(entity.get("angle", 0))
        except ValueError:
            continue
        if SEEN_FROM.match(name) and len(at) == 3 and all(map(math.isfinite, [*at, yaw])):
            player = "player" in name or "spawn" in name
            found.append((not player, [*at[:2], at[2] + (EYES if player else FLOOR)], yaw if player else None))
    found.sort(key=lambda one: one[:2])
    chosen = found[:1]
    while found and len(chosen) < min(count, len(found)):
        far = max(found, key=lambda one: min(math.dist(one[1], other[1]) for other in chosen))
        if far in chosen:
            break
        chosen.append(far)
    middle = [sum(one[1][i] for one in chosen) / len(chosen) for i in (0, 1)] if chosen else [0, 0]
    views = [[*at, math.degrees(math.atan2(middle[1] - at[1], middle[0] - at[0])) if yaw is None else yaw]
             for _, at, yaw in chosen]
    return [[*at, (yaw + turn) % 360] for turn in (0, 180, 90, 270) for *at, yaw in views][:count]
