// GPL-2.0-or-later. A map as values: records of the lumps that the page shows, checked before use.
import { expect, float32s, int32s, textAt, viewOf } from './bytes.js';
import { Lump, readContainer } from './container.js';
import { parseEntities } from './entities.js';

export const SurfaceType = { planar: 1, patch: 2, triangles: 3, flare: 4, foliage: 5 };

/** Bits of surfaceFlags, those of Quake III. */
export const SurfaceFlag = { sky: 0x4, noDraw: 0x80 };
const kRbspSky = 0x2000;
const kRbspNoDraw = 0x200000;

/** Styles from here on mark a free slot, and end the list of a surface. */
const kFreeStyle = 254;
/** Most light styles of a surface. */
export const kSlots = 4;

/** Sizes of records, and where their fields for the light of each slot are, in words of 32 bits. IBSP has one slot. */
const kIbspRecords = { slots: 1, vertex: 11, normal: 7, color: 10, surface: 26, pages: 7, patch: 24 };
const kRbspRecords = { slots: kSlots, vertex: 20, normal: 13, color: 16, surface: 37, styles: 7, pages: 9, patch: 35 };

/** Names of the fields of vertices that hold lightmap coordinates and colors of a slot. */
export const lightmapField = (slot) => (slot === 0 ? 'lightmap' : `lightmap${slot}`);
export const colorField = (slot) => (slot === 0 ? 'color' : `color${slot}`);

/** Whole records of a lump as integers or floats, `count` 32-bit words each. */
function records(bytes, words, name) {
    expect(bytes.length % (4 * words) === 0, `The lump of ${name} does not hold whole records.`);
    return { ints: int32s(bytes), floats: float32s(bytes), count: bytes.length / (4 * words) };
}

/** Flags of a record with the bits of SurfaceFlag. RBSP files have bits of their own. */
function surfaceFlags(flags, ident) {
    if (ident !== 'RBSP') return flags;
    return ((flags & kRbspSky) !== 0 ? SurfaceFlag.sky : 0) | ((flags & kRbspNoDraw) !== 0 ? SurfaceFlag.noDraw : 0);
}

function readShaders(bytes, ident) {
    expect(bytes.length % 72 === 0, 'The lump of shaders does not hold whole records.');
    const view = viewOf(bytes);
    return Array.from({ length: bytes.length / 72 }, (_, i) => ({
        name: textAt(bytes, 72 * i, 64)
            .toLowerCase()
            .replaceAll('\\', '/'),
        surfaceFlags: surfaceFlags(view.getUint32(72 * i + 64, true), ident),
    }));
}

/** Arrays of positions, texture coordinates and normals, and for each slot of lightmap coordinates and colors. */
function readVertices(bytes, format) {
    const { floats, count } = records(bytes, format.vertex, 'vertices');
    const vertices = {
        count,
        position: new Float32Array(3 * count),
        st: new Float32Array(2 * count),
        normal: new Float32Array(3 * count),
    };
    const slots = Array.from({ length: format.slots }, (_, slot) => ({
        lightmap: (vertices[lightmapField(slot)] = new Float32Array(2 * count)),
        color: (vertices[colorField(slot)] = new Uint8Array(4 * count)),
    }));
    for (let i = 0; i < count; i++) {
        const at = format.vertex * i;
        vertices.position.set(floats.subarray(at, at + 3), 3 * i);
        vertices.st.set(floats.subarray(at + 3, at + 5), 2 * i);
        vertices.normal.set(floats.subarray(at + format.normal, at + format.normal + 3), 3 * i);
        slots.forEach(({ lightmap, color }, slot) => {
            lightmap.set(floats.subarray(at + 5 + 2 * slot, at + 7 + 2 * slot), 2 * i);
            const colorAt = 4 * (at + format.color + slot);
            color.set(bytes.subarray(colorAt, colorAt + 4), 4 * i);
        });
    }
    const finite = (array) => array.every(Number.isFinite);
    expect(
        finite(vertices.position) && finite(vertices.normal),
        'A vertex has a position or normal that is no number.',
    );
    for (const array of [vertices.st, ...slots.map(({ lightmap }) => lightmap)])
        // may be no numbers where they are not used
        for (let i = 0; i < array.length; i++) if (!Number.isFinite(array[i])) array[i] = 0;
    return vertices;
}

/** Styles of the used slots, of four bytes of a surface. */
function usedStyles(bytes, offset) {
    const styles = [...bytes.subarray(offset, offset + kSlots)];
    const free = styles.findIndex((style) => style >= kFreeStyle);
    return free < 0 ? styles : styles.slice(0, free);
}

function readSurfaces(bytes, format, shaderCount, vertexCount, indexes) {
    const { ints, count } = records(bytes, format.surface, 'surfaces');
    return Array.from({ length: count }, (_, i) => {
        const at = (field) => ints[format.surface * i + field];
        const styles = (field) => (format.styles ? usedStyles(bytes, 4 * (format.surface * i + field)) : [0]);
        const surface = {
            shader: at(0),
            type: at(2),
            firstVertex: at(3),
            vertexCount: at(4),
            firstIndex: at(5),
            indexCount: at(6),
            pages: Array.from({ length: format.slots }, (_, slot) => at(format.pages + slot)),
            lightmapStyles: styles(format.styles),
            vertexStyles: styles(format.styles + 1),
            patchWidth: at(format.patch),
            patchHeight: at(format.patch + 1),
        };
        checkSurface(surface, i, shaderCount, vertexCount, indexes);
        return surface;
    });
}

function checkSurface(surface, i, shaderCount, vertexCount, indexes) {
    const within = (first, count, all) => first >= 0 && count >= 0 && first + count <= all;
    expect(surface.shader >= 0 && surface.shader < shaderCount, `Surface ${i} has no shader.`);
    if (surface.type === SurfaceType.flare) return;
    expect(
        within(surface.firstVertex, surface.vertexCount, vertexCount),
        `Surface ${i} has vertices that do not exist.`,
    );
    if (surface.type === SurfaceType.patch) {
        const side = (n) => n >= 3 && n <= 31 && n % 2 === 1;
        expect(
            side(surface.patchWidth) &&
                side(surface.patchHeight) &&
                surface.patchWidth * surface.patchHeight === surface.vertexCount,
            `The patch of surface ${i} is damaged.`,
        );
        return;
    }
    expect(
        within(surface.firstIndex, surface.indexCount, indexes.length) && surface.indexCount % 3 === 0,
        `Surface ${i} has indexes that do not exist.`,
    );
    for (let k = surface.firstIndex; k < surface.firstIndex + surface.indexCount; k++)
        expect(indexes[k] >= 0 && indexes[k] < surface.vertexCount, `Surface ${i} has an index past its vertices.`);
}

function readModels(bytes, surfaceCount) {
    const { ints, floats, count } = records(bytes, 10, 'models');
    expect(count > 0, 'The map has no world model.');
    return Array.from({ length: count }, (_, i) => {
        const model = {
            mins: [...floats.subarray(10 * i, 10 * i + 3)],
            maxs: [...floats.subarray(10 * i + 3, 10 * i + 6)],
            firstSurface: ints[10 * i + 6],
            surfaceCount: ints[10 * i + 7],
        };
        expect([...model.mins, ...model.maxs].every(Number.isFinite), `Model ${i} has bounds that are no numbers.`);
        expect(
            model.firstSurface >= 0 &&
                model.surfaceCount >= 0 &&
                model.firstSurface + model.surfaceCount <= surfaceCount,
            `Model ${i} has surfaces that do not exist.`,
        );
        return model;
    });
}

/** The BSP tree with its leafs and visibility; see tree.js. */
function readTree(lumps) {
    const planes = records(lumps[Lump.planes], 4, 'planes');
    const nodes = records(lumps[Lump.nodes], 9, 'nodes');
    const leafs = records(lumps[Lump.leafs], 12, 'leafs');
    const leafSurfaces = int32s(lumps[Lump.leafSurfaces]);
    expect(planes.count > 0 && nodes.count > 0 && leafs.count > 0, 'The map has no BSP tree.');
    return {
        planes: planes.floats,
        planeCount: planes.count,
        nodes: nodes.ints,
        nodeCount: nodes.count,
        leafs: leafs.ints,
        leafCount: leafs.count,
        leafSurfaces,
        visibility: lumps[Lump.visibility],
    };
}

/** Light styles of surfaces other than 0. */
function stylesOf(surfaces) {
    const all = surfaces.flatMap(({ lightmapStyles, vertexStyles }) => [...lightmapStyles, ...vertexStyles]);
    return [...new Set(all)].filter((style) => style !== 0);
}

/** Texels along a side of the lightmap pages in the file. */
function lightmapSide(ident, world) {
    if (ident !== 'FBSP') return 128;
    const side = Number(world?.get('_lightmapimagesize'));
    return Number.isInteger(Math.log2(side)) && side >= 16 && side <= 8192 ? side : 512;
}

/**
 * Reads a map. Light grids are read apart (grids.js), so that the map shows without them.
 * @param {Uint8Array} bytes the whole file
 * @throws FormatError
 */
export function readMap(bytes) {
    const container = readContainer(bytes);
    const { lumps } = container;
    const entityText = textAt(lumps[Lump.entities], 0, lumps[Lump.entities].length);
    const entities = parseEntities(entityText);
    const format = container.ident === 'IBSP' ? kIbspRecords : kRbspRecords;
    const shaders = readShaders(lumps[Lump.shaders], container.ident);
    const vertices = readVertices(lumps[Lump.drawVerts], format);
    const indexes = int32s(lumps[Lump.drawIndexes]);
    const surfaces = readSurfaces(lumps[Lump.surfaces], format, shaders.length, vertices.count, indexes);
    return {
        ...container,
        bytes: bytes.length,
        entities,
        shaders,
        vertices,
        indexes,
        surfaces,
        models: readModels(lumps[Lump.models], surfaces.length),
        tree: readTree(lumps),
        lightmaps: lumps[Lump.lightmaps],
        lightmapSide: lightmapSide(container.ident, entities[0]),
        styles: stylesOf(surfaces),
    };
}
