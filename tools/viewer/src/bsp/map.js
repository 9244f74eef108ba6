// GPL-2.0-or-later. A map as values: records of the lumps that the page shows, checked before use.
import { expect, float32s, int32s, textAt, viewOf } from './bytes.js';
import { Lump, readContainer } from './container.js';
import { parseEntities } from './entities.js';

export const SurfaceType = { planar: 1, patch: 2, triangles: 3, flare: 4, foliage: 5 };

const kVertexBytes = 44;
const kSurfaceInts = 26;

/** Whole records of a lump as integers or floats, `count` 32-bit words each. */
function records(bytes, words, name) {
    expect(bytes.length % (4 * words) === 0, `The lump of ${name} does not hold whole records.`);
    return { ints: int32s(bytes), floats: float32s(bytes), count: bytes.length / (4 * words) };
}

function readShaders(bytes) {
    expect(bytes.length % 72 === 0, 'The lump of shaders does not hold whole records.');
    const view = viewOf(bytes);
    return Array.from({ length: bytes.length / 72 }, (_, i) => ({
        name: textAt(bytes, 72 * i, 64)
            .toLowerCase()
            .replaceAll('\\', '/'),
        surfaceFlags: view.getUint32(72 * i + 64, true),
    }));
}

/** Arrays of positions, texture and lightmap coordinates, normals and colors. */
function readVertices(bytes) {
    const { floats, count } = records(bytes, kVertexBytes / 4, 'vertices');
    const vertices = {
        count,
        position: new Float32Array(3 * count),
        st: new Float32Array(2 * count),
        lightmap: new Float32Array(2 * count),
        normal: new Float32Array(3 * count),
        color: new Uint8Array(4 * count),
    };
    for (let i = 0; i < count; i++) {
        const at = 11 * i;
        vertices.position.set(floats.subarray(at, at + 3), 3 * i);
        vertices.st.set(floats.subarray(at + 3, at + 5), 2 * i);
        vertices.lightmap.set(floats.subarray(at + 5, at + 7), 2 * i);
        vertices.normal.set(floats.subarray(at + 7, at + 10), 3 * i);
        vertices.color.set(bytes.subarray(kVertexBytes * i + 40, kVertexBytes * i + 44), 4 * i);
    }
    const finite = (array) => array.every(Number.isFinite);
    expect(
        finite(vertices.position) && finite(vertices.normal),
        'A vertex has a position or normal that is no number.',
    );
    for (const array of [vertices.st, vertices.lightmap])
        // may be no numbers where they are not used
        for (let i = 0; i < array.length; i++) if (!Number.isFinite(array[i])) array[i] = 0;
    return vertices;
}

function readSurfaces(bytes, shaderCount, vertexCount, indexes) {
    const { ints, count } = records(bytes, kSurfaceInts, 'surfaces');
    return Array.from({ length: count }, (_, i) => {
        const at = (field) => ints[kSurfaceInts * i + field];
        const surface = {
            shader: at(0),
            type: at(2),
            firstVertex: at(3),
            vertexCount: at(4),
            firstIndex: at(5),
            indexCount: at(6),
            lightmap: at(7),
            patchWidth: at(24),
            patchHeight: at(25),
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

/**
 * Reads a map. Light grids are read apart (grids.js), so that the map shows without them.
 * @param {Uint8Array} bytes the whole file
 * @throws FormatError
 */
export function readMap(bytes) {
    const container = readContainer(bytes);
    const { lumps } = container;
    const entityText = textAt(lumps[Lump.entities], 0, lumps[Lump.entities].length);
    const shaders = readShaders(lumps[Lump.shaders]);
    const vertices = readVertices(lumps[Lump.drawVerts]);
    const indexes = int32s(lumps[Lump.drawIndexes]);
    const surfaces = readSurfaces(lumps[Lump.surfaces], shaders.length, vertices.count, indexes);
    return {
        ...container,
        bytes: bytes.length,
        entities: parseEntities(entityText),
        shaders,
        vertices,
        indexes,
        surfaces,
        models: readModels(lumps[Lump.models], surfaces.length),
        tree: readTree(lumps),
        lightmaps: lumps[Lump.lightmaps],
    };
}
