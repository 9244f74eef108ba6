# GPL-2.0-or-later. Checked access to the lumps of IBSP files, for the scripts of this folder.
"""Reads what the scripts compare. The layout is in docs/reference/bsp_format.md."""

import array
import math
import re
import struct
import sys
from pathlib import Path

ENTITIES, PLANES, NODES, LEAFS, MODELS, LIGHTGRID, LIGHTGRID_SH = 0, 2, 3, 4, 7, 15, 18
BSPX_NAME = b"LIGHTGRID_SH"
SH_HEADER, SH_POINT = struct.Struct("<3f3f3ii"), 108  # mins, cell, bounds, number of points; bytes of a point
LUMPS, WIDE_LUMPS = 17, 19  # WIDE_LUMPS: version 47, with advertisements and the SH grid


def header_size(lumps):
    """Bytes before the lumps: magic, version, and offset and length of each."""
    return 8 + 8 * lumps



class BspError(Exception):
    """A file that cannot be read; the text names it."""


class BspFile:
    """Lumps of one file. Raises BspError when the header does not fit the file."""

    def __init__(self, path):
        self.path = Path(path)
        try:
            self.data = self.path.read_bytes()
        except OSError as error:
            raise BspError(f"{path}: {error.strerror}") from error
        if len(self.data) < header_size(LUMPS) or self.data[:4] != b"IBSP":
            raise BspError(f"{path}: not an IBSP file")
        self.slots = [self._slot(i) for i in range(LUMPS)]
        used = [offset for offset, length in self.slots if length > 0]
        version = struct.unpack_from("<i", self.data, 4)[0]
        wide = header_size(WIDE_LUMPS)
        if version == 47 and len(self.data) >= wide and min(used, default=wide) >= wide:
            self.slots += [self._slot(i) for i in range(LUMPS, WIDE_LUMPS)]

    def _slot(self, index):
        offset, length = struct.unpack_from("<ii", self.data, 8 + 8 * index)
        if offset < 0 or length < 0 or offset + length > len(self.data):
            raise BspError(f"{self.path}: lump {index} at {offset} with {length} bytes is not in the file")
        return offset, length

    def lump(self, index):
        """Bytes of a lump, empty when the file has none."""
        if index >= len(self.slots):
            return b""
        offset, length = self.slots[index]
        return self.data[offset:offset + length]

    def records(self, index, layout):
        """A list of tuples; layout as in the struct module."""
        record = struct.Struct("<" + layout)
        lump = self.lump(index)
        return list(record.iter_unpack(lump[:len(lump) // record.size * record.size]))

    def _bspx(self):
        """The SH grid of a BSPX directory, empty without one."""
        end = max(offset + length for offset, length in self.slots)
        at = (end + 3) // 4 * 4  # the directory is aligned to 4 bytes: "BSPX", a count, 32 bytes for each lump
        if self.data[at:at + 4] != b"BSPX" or at + 8 > len(self.data):
            return b""
        count = struct.unpack_from("<I", self.data, at + 4)[0]
        if at + 8 + 32 * count > len(self.data):
            return b""
        for i in range(count):
            name, offset, length = struct.unpack_from("<24sII", self.data, at + 8 + 32 * i)
            if name.rstrip(b"\0") == BSPX_NAME:
                return self.data[offset:offset + length]
        return b""

    def sh_grid(self):
        """(bounds, 27 floats a point as one array) or None."""
        lump = self.lump(LIGHTGRID_SH) or self._bspx()
        if not lump:
            return None
        if len(lump) < SH_HEADER.size:
            raise BspError(f"{self.path}: the SH grid has {len(lump)} bytes")
        header = SH_HEADER.unpack_from(lump)
        bounds, points = header[6:9], header[9]
        if min(bounds) < 1 or math.prod(bounds) != points or len(lump) != SH_HEADER.size + SH_POINT * points:
            raise BspError(f"{self.path}: the SH grid has {len(lump)} bytes, bounds {bounds} and {points} points")
        values = array.array("f")
        values.frombytes(lump[SH_HEADER.size:])
        if sys.byteorder == "big":
            values.byteswap()
        return bounds, values

    def legacy_layout(self):
        """(mins, cell, bounds) of the legacy grid: world model and worldspawn key gridsize."""
        models = self.records(MODELS, "3f3f4i")
        if not models:
            raise BspError(f"{self.path}: no models")
        if not all(math.isfinite(v) for v in models[0][:6]):
            raise BspError(f"{self.path}: the world model has no bounds")
        cell = [64.0, 64.0, 128.0]
        world = self.lump(ENTITIES).split(b"}", 1)[0]
        found = re.search(rb'"gridsize"\s+"\s*([-\d.]+)\s+([-\d.]+)\s+([-\d.]+)', world, re.IGNORECASE)
        if found:
            cell = [max(8.0, math.floor(float(text))) for text in found.groups()]
        mins = [cell[i] * math.ceil(models[0][i] / cell[i]) for i in range(3)]
        last = [cell[i] * math.floor(models[0][3 + i] / cell[i]) for i in range(3)]
        return mins, cell, [int((last[i] - mins[i]) / cell[i]) + 1 for i in range(3)]


class SolidTest:
    """Whether positions lie in solid leafs."""

    def __init__(self, bsp):
        self.planes = bsp.records(PLANES, "4f")
        self.nodes = bsp.records(NODES, "9i")
        self.leafs = bsp.records(LEAFS, "12i")
        if any(not 0 <= node[0] < len(self.planes) or not -len(self.leafs) <= child < len(self.nodes)
               for node in self.nodes for child in node[1:3]):
            raise BspError(f"{bsp.path}: a node has a plane or a child that is not there")

    def solid(self, x, y, z):
        """On a plane counts as in front."""
        child, depth = (0, 0) if self.nodes else (-1, 0)
        while child >= 0 and depth <= len(self.nodes):
            plane, front, back = self.nodes[child][:3]
            a, b, c, dist = self.planes[plane]
            child = front if a * x + b * y + c * z >= dist else back
            depth += 1
        return not self.leafs or child >= 0 or self.leafs[-1 - child][0] < 0
