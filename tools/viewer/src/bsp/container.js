// GPL-2.0-or-later. The lumps of IBSP 46 and 47, of RBSP and FBSP, and those of a BSPX directory. See
// docs/reference/bsp_format.md.
import { expect, textAt, viewOf } from './bytes.js';

export const Lump = {
    entities: 0,
    shaders: 1,
    planes: 2,
    nodes: 3,
    leafs: 4,
    leafSurfaces: 5,
    leafBrushes: 6,
    models: 7,
    brushes: 8,
    brushSides: 9,
    drawVerts: 10,
    drawIndexes: 11,
    fogs: 12,
    surfaces: 13,
    lightmaps: 14,
    lightGrid: 15,
    visibility: 16,
    advertisements: 17, // IBSP 47
    lightGridSH: 18, // IBSP 47
    lightArray: 17, // RBSP and FBSP
};

/** Slots that every file of a format has; some IBSP files of version 47 have slots 17 and 18 too. */
const kFormats = {
    IBSP: { versions: [46, 47], slots: 17 },
    RBSP: { versions: [1], slots: 18 },
    FBSP: { versions: [1], slots: 18 },
};
const slotEnd = (slots) => 8 + 8 * slots;

/** Offset and length in slot i; null if they lie outside the file. */
function slotAt(view, i) {
    const offset = view.getUint32(8 + 8 * i, true);
    const length = view.getUint32(12 + 8 * i, true);
    return offset + length <= view.byteLength ? { offset, length } : null;
}

/**
 * Adds slot 17 or 18 of version 47, which exist only if no lump begins before the slot ends.
 * A slot 18 that cannot be a lump is a problem only if the first lump begins right after it.
 */
function addLateSlots(bytes, view, lumps, first, problems) {
    let end = 0;
    for (const slot of [Lump.advertisements, Lump.lightGridSH]) {
        const headerEnd = slotEnd(slot + 1);
        if (first < headerEnd || bytes.length < headerEnd) continue;
        const range = slotAt(view, slot);
        const inside = range && range.offset >= headerEnd;
        const whole = inside && (slot === Lump.lightGridSH ? range.length > 40 : range.length % 128 === 0);
        if (whole && range.length > 0) {
            lumps[slot] = bytes.subarray(range.offset, range.offset + range.length);
            end = range.offset + range.length;
        } else if (slot === Lump.lightGridSH && first === headerEnd && view.getUint32(12 + 8 * slot, true) > 0) {
            problems.push('Lump 18, the SH light grid, is cut off or lies outside the file.');
        }
    }
    return end;
}

/** The lumps of a BSPX directory at `start` by name; the first of two with one name. */
function readBspx(bytes, view, start, problems) {
    const lumps = new Map();
    if (start + 8 > bytes.length || textAt(bytes, start, 4) !== 'BSPX') return lumps;
    const count = view.getUint32(start + 4, true);
    if (count > (bytes.length - start - 8) / 32) {
        problems.push(`The BSPX directory names ${count} lumps, which do not fit into the file.`);
        return lumps;
    }
    for (let i = 0; i < count; i++) {
        const entry = start + 8 + 32 * i;
        const name = textAt(bytes, entry, 24);
        const offset = view.getUint32(entry + 24, true);
        const length = view.getUint32(entry + 28, true);
        if (offset < start + 8 + 32 * count || offset + length > bytes.length)
            problems.push(`The BSPX lump ${name} lies outside the file.`);
        else if (!lumps.has(name)) lumps.set(name, bytes.subarray(offset, offset + length));
    }
    return lumps;
}

/**
 * Reads the table of lumps.
 * @param {Uint8Array} bytes the whole file
 * @returns {{ident: string, version: number, lumps: Uint8Array[], bspx: Map<string, Uint8Array>, problems: string[]}}
 *   problems: parts that were left out, each a sentence
 * @throws FormatError if the file is none of kFormats, or a lump lies outside of it
 */
export function readContainer(bytes) {
    const view = viewOf(bytes);
    const ident = textAt(bytes, 0, Math.min(4, bytes.length));
    expect(
        Object.hasOwn(kFormats, ident),
        `This is not a Quake 3 map: it begins with "${ident.replace(/[^ -~]/g, '?')}", not IBSP, RBSP or FBSP.`,
    );
    const { versions, slots } = kFormats[ident];
    expect(bytes.length >= slotEnd(slots), `The map ends in its header, after ${bytes.length} bytes.`);
    const version = view.getInt32(4, true);
    expect(
        versions.includes(version),
        `The map is an ${ident} of version ${version}; this page reads ${versions.join(' and ')}.`,
    );
    const lumps = [];
    const problems = [];
    let first = Infinity;
    let end = 0;
    for (let i = 0; i < slots; i++) {
        const range = slotAt(view, i);
        expect(
            range && (range.length === 0 || range.offset >= slotEnd(slots)),
            `Lump ${i} lies outside the file: the map is damaged or was not copied completely.`,
        );
        lumps.push(bytes.subarray(range.offset, range.offset + range.length));
        if (range.length > 0) first = Math.min(first, range.offset);
        end = Math.max(end, range.offset + range.length);
    }
    if (version === 47) end = Math.max(end, addLateSlots(bytes, view, lumps, first, problems));
    return { ident, version, lumps, bspx: readBspx(bytes, view, (end + 3) & ~3, problems), problems };
}
