// GPL-2.0-or-later. Small maps and lumps as bytes, written from docs/reference/bsp_format.md alone.

/** Joins parts: numbers are 32-bit words as [type, value], others bytes. */
export function bytesOf(...parts) {
    const arrays = parts.map((part) => {
        if (part instanceof Uint8Array) return part;
        if (typeof part === 'string') return Uint8Array.from(part, (c) => c.charCodeAt(0));
        const bytes = new Uint8Array(4);
        const view = new DataView(bytes.buffer);
        if (part.f !== undefined) view.setFloat32(0, part.f, true);
        else view.setUint32(0, part.u >>> 0, true);
        return bytes;
    });
    const joined = new Uint8Array(arrays.reduce((sum, array) => sum + array.length, 0));
    let at = 0;
    for (const array of arrays) {
        joined.set(array, at);
        at += array.length;
    }
    return joined;
}

export const f = (...values) => bytesOf(...values.map((value) => ({ f: value })));
export const u = (...values) => bytesOf(...values.map((value) => ({ u: value })));

/** Text padded with NUL to a length. */
export function name(text, length) {
    return bytesOf(text, new Uint8Array(length - text.length));
}

/** Lumps of a room of one node: behind its plane, x = 0, is solid; before it cluster 0. One triangle, no lightmap. */
export function roomLumps() {
    const vertex = (x, y, z) => bytesOf(f(x, y, z, 0, 0, 0, 0, 0, 0, 1), Uint8Array.of(10, 20, 30, 255));
    const lumps = Array.from({ length: 17 }, () => new Uint8Array());
    lumps[0] = bytesOf(
        '{ "classname" "worldspawn" }\n{ "classname" "light" "origin" "8 9 10" "_color" "0.5 1 0" }\n\0',
    );
    lumps[1] = bytesOf(name('textures/a/b', 64), u(0, 1));
    lumps[2] = f(1, 0, 0, 0);
    lumps[3] = u(0, -1, -2, 0, 0, 0, 0, 0, 0);
    lumps[4] = bytesOf(u(0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0), u(-1, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
    lumps[5] = u(0);
    lumps[7] = bytesOf(f(-128, -128, -128, 128, 128, 128), u(0, 1, 0, 0));
    lumps[10] = bytesOf(vertex(0, 0, 0), vertex(64, 0, 0), vertex(0, 64, 0));
    lumps[11] = u(0, 1, 2);
    lumps[13] = bytesOf(u(0, -1, 1, 0, 3, 0, 3, -3, 0, 0, 0, 0), f(...new Array(12).fill(0)), u(0, 0));
    lumps[16] = bytesOf(u(1, 1), Uint8Array.of(1));
    return lumps;
}

/**
 * The lumps of roomLumps as RBSP and FBSP files have them. Light of style 0 is 10 20 30, that of style 33 40 0 2, on the
 * vertices and on two lightmap pages with that many texels along a side; `pages` says which of them the triangle has.
 */
export function styledLumps(pages, side, world = '') {
    const free = [new Uint8Array(4), new Uint8Array(4)];
    const colors = [Uint8Array.of(10, 20, 30, 255), Uint8Array.of(40, 0, 2, 255), ...free];
    const vertex = (x, y, z) => bytesOf(f(x, y, z, 0, 0, 0.5, 0.5, 0.25, 0.75, NaN, 0, 0, 0, 0, 0, 1), ...colors);
    const styles = Uint8Array.of(0, 33, 255, 255);
    const numbers = f(...new Array(12).fill(0)); // origin and vectors
    const page = (color) => Uint8Array.from({ length: 3 * side * side }, (_, i) => color[i % 3]);
    const lumps = [...roomLumps(), new Uint8Array()];
    const lamp = '{ "classname" "light" "targetname" "lamp" "style" "33" "origin" "0 0 0" }';
    lumps[0] = bytesOf(`{ "classname" "worldspawn" ${world} }\n${lamp}\0`);
    lumps[9] = u(0, 0, -1);
    lumps[10] = bytesOf(vertex(0, 0, 0), vertex(64, 0, 0), vertex(0, 64, 0));
    const surface = u(0, -1, 1, 0, 3, 0, 3);
    lumps[13] = bytesOf(surface, styles, styles, u(...pages, ...new Array(10).fill(0)), numbers, u(0, 0));
    lumps[14] = bytesOf(page(colors[0]), page(colors[1]));
    return lumps;
}

/** A record of the light grid of RBSP and FBSP: for each slot its style, ambient and directed light; it is from +x. */
export function gridRecord(...slots) {
    const values = (of) => [0, 1, 2, 3].flatMap((slot) => (slots[slot] ? of(slots[slot]) : [0, 0, 0]));
    const styles = [0, 1, 2, 3].map((slot) => slots[slot]?.style ?? 255);
    return Uint8Array.of(...values(({ ambient }) => ambient), ...values(({ directed }) => directed), ...styles, 64, 0);
}

/** A light array. */
export const u16 = (...values) => Uint8Array.from(values.flatMap((value) => [value & 255, value >> 8]));

/** A file of these lumps, and of BSPX lumps [name, bytes]. */
export function makeBsp(version, lumps, bspx = [], ident = 'IBSP') {
    const table = 8 + 8 * lumps.length;
    const parts = [];
    const entries = [];
    let at = table;
    const put = (bytes) => {
        const start = at;
        parts.push(bytes, new Uint8Array(-bytes.length & 3));
        at += bytes.length + (-bytes.length & 3);
        return start;
    };
    for (const lump of lumps) entries.push(u(put(lump), lump.length));
    const directory = at + 8 + 32 * bspx.length;
    let offset = directory;
    const names = bspx.map(([key, bytes]) => {
        const entry = bytesOf(name(key, 24), u(offset, bytes.length));
        offset += bytes.length;
        return entry;
    });
    const tail = bspx.length > 0 ? [bytesOf('BSPX', u(bspx.length)), ...names, ...bspx.map(([, bytes]) => bytes)] : [];
    return bytesOf(ident, u(version), ...entries, ...parts, ...tail);
}

/** A uniform grid: coefficients of point i are value(i, k), k from 0 to 26. */
export function uniformLump(mins, cell, bounds, value) {
    const count = bounds[0] * bounds[1] * bounds[2];
    const values = new Float32Array(27 * count);
    for (let i = 0; i < count; i++) for (let k = 0; k < 27; k++) values[27 * i + k] = value(i, k);
    return bytesOf(f(...mins, ...cell), u(...bounds, count), new Uint8Array(values.buffer));
}

/**
 * A sparse grid of one root: its octant 0 is a node of 8 stored cells, octants 1 to 7 are stored cells, but octant 7,
 * which has no value. Coefficient 0 of point i is (i + 1) / 16 in red; the others are 0 but coefficient 3 of point 0,
 * which is half its limit.
 */
export function sparseLump() {
    const code = (i) => ({ u: ((i + 1) * 16) | (16 << 27) }); // mantissa * 2^-8
    const point = (i) =>
        bytesOf(
            code(i),
            Uint8Array.from({ length: 24 }, (_, k) => (i === 0 && k === 6 ? 64 : 0)),
        );
    const nodes = bytesOf(
        u(1, 0),
        Uint8Array.of(0b00000001, 0b01111110, 0, 128),
        u(2, 6),
        Uint8Array.of(0, 0xff, 0, 128),
    );
    const points = bytesOf(...Array.from({ length: 14 }, (_, i) => point(i < 6 ? i + 8 : i - 6)));
    const head = bytesOf('SHGS', u(1, 64 + 24 + 28 * 14), f(0, 0, 0, 8, 8, 8), u(1, 1, 1, 2, 2, 14, 0));
    return bytesOf(head, nodes, points);
}
