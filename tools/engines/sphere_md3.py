# GPL-2.0-or-later. Writes a white sphere as a Quake III model, for pictures of the light of entities.
"""The vertices are on 128 meridians and 65 rings, 360 / 128 degrees apart. MD3 stores a normal as two angles in steps
of 360 / 256 degrees, so all normals are exact. The sphere is split into 16 surfaces of 645 vertices, since renderer 1
takes at most 1000 a surface."""

import math
import struct

RADIUS = 16  # game units; kSphereRadius in sphere_light
SEGMENTS, RINGS, BANDS = 128, 64, 16
RINGS_OF_BAND = RINGS // BANDS

MODEL = "models/shsphere/sphere.md3"
SHADER = "models/shsphere/white"
SHADER_TEXT = SHADER + """
{
    {
        map $whiteimage
        rgbGen lightingDiffuse
    }
}
"""


def _name(text, size):
    return text.encode().ljust(size, b"\0")


def _vertex(ring, segment):
    polar, around = math.pi * ring / RINGS, 2 * math.pi * segment / SEGMENTS
    normal = (math.cos(around) * math.sin(polar), math.sin(around) * math.sin(polar), math.cos(polar))
    position = (round(64 * RADIUS * c) for c in normal)  # 1/64 unit
    angles = (256 * ring // (2 * RINGS), 256 * segment // SEGMENTS % 256)
    return struct.pack("<3h2B", *position, *angles)


def _band(number):
    """A surface: some rings of triangles, clockwise as seen from outside."""
    first, columns = number * RINGS_OF_BAND, SEGMENTS + 1
    vertices, texture, triangles = [], [], []
    for ring in range(first, first + RINGS_OF_BAND + 1):
        for segment in range(columns):
            vertices.append(_vertex(ring, segment))
            texture.append(struct.pack("<2f", segment / SEGMENTS, ring / RINGS))
    for ring in range(RINGS_OF_BAND):
        for segment in range(SEGMENTS):
            a = ring * columns + segment
            b = a + columns
            triangles += [struct.pack("<3i", a, a + 1, b), struct.pack("<3i", b, a + 1, b + 1)]
    parts = [b"".join(triangles), _name(SHADER, 64) + struct.pack("<i", 0), b"".join(texture), b"".join(vertices)]
    offsets = [108]
    for part in parts:
        offsets.append(offsets[-1] + len(part))
    head = struct.pack("<10i", 0, 1, 1, len(vertices), len(triangles), *offsets)
    return b"IDP3" + _name(f"band{number}", 64) + head + b"".join(parts)


def sphere():
    """The bytes of the model."""
    bands = b"".join(_band(i) for i in range(BANDS))
    bounds = [-RADIUS] * 3 + [RADIUS] * 3 + [0] * 3 + [RADIUS]
    frame = struct.pack("<10f", *bounds) + _name("sphere", 16)
    surfaces = 108 + len(frame)
    head = struct.pack("<9i", 0, 1, 0, BANDS, 0, 108, surfaces, surfaces, surfaces + len(bands))
    return b"IDP3" + struct.pack("<i", 15) + _name(MODEL, 64) + head + frame + bands
