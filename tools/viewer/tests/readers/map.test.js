// GPL-2.0-or-later. Maps and their containers.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FormatError } from '../../src/bsp/bytes.js';
import { lightEntities, namesOfStyle, parseEntities, startPosition } from '../../src/bsp/entities.js';
import { readGrids } from '../../src/bsp/grids.js';
import { SurfaceFlag, readMap } from '../../src/bsp/map.js';
import { tessellate } from '../../src/bsp/patch.js';
import { BspTree } from '../../src/bsp/tree.js';
import { gridRecord, makeBsp, roomLumps, sparseLump, styledLumps, u16, uniformLump } from './make_bsp.js';

const uniform = uniformLump([0, 0, 0], [32, 32, 64], [2, 2, 2], (i, k) => (k < 3 ? i : 0));

test('a map of version 46 is read', () => {
    const map = readMap(makeBsp(46, roomLumps()));
    assert.equal(map.version, 46);
    assert.equal(map.shaders[0].name, 'textures/a/b');
    assert.deepEqual([...map.vertices.position], [0, 0, 0, 64, 0, 0, 0, 64, 0]);
    assert.deepEqual([...map.vertices.color.subarray(0, 4)], [10, 20, 30, 255]);
    assert.equal(map.surfaces[0].indexCount, 3);
    assert.deepEqual(map.problems, []);
});

for (const ident of ['RBSP', 'FBSP'])
    test(`a map of ${ident} is read: light of each style`, () => {
        const map = readMap(makeBsp(1, styledLumps([4, 7, -3, -3], 2), [], ident));
        assert.deepEqual([map.ident, map.version, map.problems], [ident, 1, []]);
        assert.deepEqual([...map.vertices.position], [0, 0, 0, 64, 0, 0, 0, 64, 0]);
        assert.deepEqual([...map.vertices.normal.subarray(0, 3)], [0, 0, 1]);
        assert.deepEqual([...map.vertices.lightmap.subarray(0, 2)], [0.5, 0.5]);
        assert.deepEqual([...map.vertices.lightmap1.subarray(0, 2)], [0.25, 0.75]);
        assert.deepEqual([...map.vertices.lightmap2.subarray(0, 2)], [0, 0]); // not a number, in a free slot
        assert.deepEqual([...map.vertices.color.subarray(8, 12)], [10, 20, 30, 255]);
        assert.deepEqual([...map.vertices.color1.subarray(0, 4)], [40, 0, 2, 255]);
        const [surface] = map.surfaces;
        assert.deepEqual([surface.lightmapStyles, surface.vertexStyles], [[0, 33], [0, 33]]);
        assert.deepEqual([surface.pages, surface.indexCount], [[4, 7, -3, -3], 3]);
        assert.deepEqual(map.styles, [33]);
        assert.deepEqual(namesOfStyle(map.entities, 33), ['lamp']);
        assert.deepEqual(readMap(makeBsp(46, roomLumps())).styles, []);
    });

test('sides of lightmap pages', () => {
    const sideOf = (ident, world) => readMap(makeBsp(1, styledLumps([0, 1, -3, -3], 2, world), [], ident)).lightmapSide;
    assert.equal(sideOf('RBSP', '"_lightmapimagesize" "256"'), 128);
    assert.equal(sideOf('FBSP', ''), 512);
    assert.equal(sideOf('FBSP', '"_lightmapimagesize" "256"'), 256);
    for (const odd of ['100', '8', '16384', 'x']) assert.equal(sideOf('FBSP', `"_lightmapimagesize" "${odd}"`), 512);
});

test('flags of skies and of what is not drawn have other bits in RBSP', () => {
    const flagsOf = (ident, flags) => {
        const lumps = styledLumps([0, 1, -3, -3], 2);
        new DataView(lumps[1].buffer).setUint32(64, flags, true);
        return readMap(makeBsp(1, lumps, [], ident)).shaders[0].surfaceFlags;
    };
    assert.equal(flagsOf('RBSP', 0x2000), SurfaceFlag.sky);
    assert.equal(flagsOf('RBSP', 0x200000), SurfaceFlag.noDraw);
    assert.equal(flagsOf('RBSP', 0x84), 0);
    assert.equal(flagsOf('FBSP', 0x84), SurfaceFlag.sky | SurfaceFlag.noDraw);
});

test('files that are no maps are refused with their reason', () => {
    assert.throws(() => readMap(new TextEncoder().encode('PK\x03\x04...')), /not IBSP/);
    assert.throws(() => readMap(new Uint8Array()), FormatError);
    assert.throws(() => readMap(makeBsp(48, roomLumps())), /version 48/);
    assert.throws(() => readMap(makeBsp(46, roomLumps()).subarray(0, 100)), /ends in its header/);
    const styled = styledLumps([0, 1, -3, -3], 2);
    assert.throws(() => readMap(makeBsp(46, styled, [], 'RBSP')), /RBSP of version 46; this page reads 1\./);
    assert.throws(() => readMap(makeBsp(1, styled, [], 'FBSP').subarray(0, 151)), /ends in its header/);
    assert.throws(() => readMap(makeBsp(1, styled, [], 'IBSP')), /IBSP of version 1; this page reads 46 and 47\./);
});

test('lump 18 is found in version 47 of 19 slots alone', () => {
    const lumps = [...roomLumps(), new Uint8Array(), uniform];
    assert.equal(readGrids(readMap(makeBsp(47, lumps))).uniform.count, 8);
    assert.equal(readGrids(readMap(makeBsp(46, lumps))).uniform, null);
    assert.equal(readGrids(readMap(makeBsp(47, roomLumps()))).uniform, null);
    const styled = [...styledLumps([0, 1, -3, -3], 2), uniform];
    assert.equal(readGrids(readMap(makeBsp(1, styled, [], 'RBSP'))).uniform, null);
});

test('BSPX lumps are found behind the others', () => {
    const grids = readGrids(
        readMap(
            makeBsp(46, roomLumps(), [
                ['LIGHTGRID_SH', uniform],
                ['LIGHTGRID_SH_SPARSE', sparseLump()],
            ]),
        ),
    );
    assert.equal(grids.uniform.count, 8);
    assert.equal(grids.sparse.count, 14);
    assert.deepEqual(grids.problems, []);
});

test('BSPX lumps are found behind the light array', () => {
    const lumps = styledLumps([0, 1, -3, -3], 2);
    for (const array of [u16(0, 0, 0), new Uint8Array()]) {
        lumps[17] = array;
        const file = makeBsp(1, lumps, [['LIGHTGRID_SH', uniform]], 'FBSP');
        assert.equal(readGrids(readMap(file)).uniform.count, 8);
    }
});

test('a damaged grid gives a message and leaves the map', () => {
    const map = readMap(makeBsp(46, roomLumps(), [['LIGHTGRID_SH_SPARSE', sparseLump().subarray(0, 200)]]));
    const grids = readGrids(map);
    assert.equal(grids.sparse, null);
    assert.match(grids.problems[0], /sparse SH light grid is cut off/);
});

test('a file cut anywhere, or with any word replaced, gives a map or a FormatError', () => {
    const grids = [
        ['LIGHTGRID_SH', uniform],
        ['LIGHTGRID_SH_SPARSE', sparseLump()],
    ];
    const styled = styledLumps([0, 1, -3, -3], 2, '"gridsize" "128 128 128"');
    styled[15] = gridRecord({ style: 0, ambient: [1, 2, 3], directed: [4, 5, 6] });
    styled[17] = u16(...new Array(27).fill(0));
    const files = [makeBsp(46, roomLumps(), grids), makeBsp(1, styled, grids, 'RBSP')];
    assert.equal(readGrids(readMap(files[1])).legacy.count, 27);
    const attempt = (bytes) => {
        try {
            const map = readMap(bytes);
            new BspTree(map.tree).clusterAt(1, 2, 3);
            const { uniform: grid, sparse, legacy } = readGrids(map);
            for (const each of [grid, sparse, legacy]) each?.sample([5, 6, 7], 1);
        } catch (error) {
            assert.ok(error instanceof FormatError, `${error.stack}`);
        }
    };
    for (const file of files) {
        for (let length = 0; length < file.length; length += 3) attempt(file.slice(0, length));
        for (let at = 4; at + 4 <= file.length; at += 4)
            for (const word of [0xffffffff, 0x7fffffff, 0x7fc00000, 7]) {
                const copy = file.slice();
                new DataView(copy.buffer).setUint32(at, word, true);
                attempt(copy);
            }
    }
});

test('clusters and what they see', () => {
    const tree = new BspTree(readMap(makeBsp(46, roomLumps())).tree);
    assert.equal(tree.clusterAt(5, 0, 0), 0);
    assert.equal(tree.clusterAt(-5, 0, 0), -1);
    assert.equal(tree.sees(0, 0), true);
    assert.equal(tree.sees(0, 1), false);
    assert.equal(tree.sees(-1, 0), true);
    assert.deepEqual(tree.surfaceClusters(1), [[0]]);
});

test('entities', () => {
    const entities = parseEntities(
        '{"classname" "worldspawn"}{ "classname" "light" "origin" "1 2 3" "_color" "0.5 0.25 0" "light" "40" }' +
            '{ "classname" "info_player_deathmatch" "origin" "10 20 30" "angle" "90" }',
    );
    assert.deepEqual(lightEntities(entities), [
        { classname: 'light', origin: [1, 2, 3], color: [1, 0.5, 0], brightness: 40 },
    ]);
    assert.deepEqual(startPosition(entities), { position: [10, 20, 56], yaw: 90 });
    assert.equal(parseEntities('no entities').length, 0);
});

test('points of a patch lie on its surface', () => {
    // A quarter of a parabolic cylinder: z = x^2 / 64 for x from 0 to 64, straight in y.
    const position = Float32Array.from([0, 32, 64].flatMap((y) => [0, y, 0, 32, y, 0, 64, y, 64]));
    const zeros = (n) => new Float32Array(9 * n);
    const vertices = { position, st: zeros(2), lightmap: zeros(2), normal: zeros(3), color: zeros(4) };
    const { vertices: out, indexes } = tessellate(vertices, { firstVertex: 0, patchWidth: 3, patchHeight: 3 });
    assert.ok(out.count >= 8);
    for (let i = 0; i < out.count; i++) {
        const [x, , z] = out.position.subarray(3 * i, 3 * i + 3);
        assert.ok(Math.abs(z - (x * x) / 64) < 1e-4);
    }
    assert.ok(Math.max(...indexes) < out.count);
});
