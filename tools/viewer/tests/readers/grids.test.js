// GPL-2.0-or-later. Light grids: values from closed forms.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { LegacyGrid, modelLight } from '../../src/bsp/grid_legacy.js';
import { SparseGridSH } from '../../src/bsp/grid_sparse.js';
import { UniformGridSH } from '../../src/bsp/grid_uniform.js';
import { readGrids } from '../../src/bsp/grids.js';
import { readMap } from '../../src/bsp/map.js';
import { parseTone, shEvaluate } from '../../src/bsp/sh.js';
import { bytesOf, gridRecord, makeBsp, roomLumps, sparseLump, styledLumps, u16, uniformLump } from './make_bsp.js';

const near = (actual, expected, tolerance = 1e-5) =>
    assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);

test('uniform light of 1 gives 1 on every normal', () => {
    const coeffs = new Float32Array(27);
    coeffs.fill(3.544908, 0, 3);
    for (const normal of [
        [1, 0, 0],
        [0, -1, 0],
        [0.6, 0, 0.8],
    ])
        near(shEvaluate(coeffs, normal)[1], 1);
});

test('light from a direction follows 0.09375 + 0.5 x + 0.46875 x^2', () => {
    // Projection of a light from +x, convolved: A_l Y(k)(+x) / pi with A = pi, 2 pi / 3, pi / 4, times pi.
    const lobes = [Math.PI, (2 * Math.PI) / 3, Math.PI / 4];
    const basis = [0.282094792, 0, 0, 0.488602512, 0, 0, -0.315391565, 0, 0.546274215];
    const coeffs = Float32Array.from(
        { length: 27 },
        (_, i) => lobes[i < 3 ? 0 : i < 12 ? 1 : 2] * basis[Math.floor(i / 3)],
    );
    for (const t of [0, 0.4, 1, 1.5]) {
        const x = Math.cos(t);
        near(shEvaluate(coeffs, [x, Math.sin(t), 0])[0], Math.max(0, 0.09375 + 0.5 * x + 0.46875 * x * x) * 1, 1e-5);
    }
});

test('a uniform grid is linear between its points and constant outside', () => {
    const grid = new UniformGridSH(uniformLump([-32, 0, 64], [32, 32, 64], [3, 2, 2], (i, k) => (k === 0 ? i % 3 : k)));
    near(grid.sample([-16, 10, 70])[0], 0.5);
    near(grid.sample([1000, 10, 70])[0], 2);
    near(grid.sample([NaN, 0, 64])[0], 0);
    near(grid.sample([5, 6, 70])[26], 26);
    const found = [];
    grid.forEachIn([-1, -1, 0], [33, 40, 100], (i, x, y, z) => found.push([i, x, y, z]));
    assert.deepEqual(found, [
        [1, 0, 0, 64],
        [2, 32, 0, 64],
        [4, 0, 32, 64],
        [5, 32, 32, 64],
    ]);
    assert.deepEqual(grid.position(10), [0, 32, 128]);
});

test('points of a sparse grid: positions, levels and values', () => {
    const grid = new SparseGridSH(sparseLump());
    assert.equal(grid.count, 14);
    assert.deepEqual(grid.position(6), [0, 0, 0]);
    assert.deepEqual(grid.position(0), [16, 0, 0]);
    assert.deepEqual([grid.level(6), grid.level(0)], [0, 1]);
    assert.deepEqual([grid.size(6), grid.size(0)], [8, 16]);
    near(grid.coeffs(6)[0], 1 / 16);
    near(grid.coeffs(6)[9], ((64 / 127) * (2 / Math.sqrt(3))) / 16);
    near(grid.coeffs(0)[0], 9 / 16);
});

test('a sparse grid blends corners that have a value', () => {
    const grid = new SparseGridSH(sparseLump());
    near(grid.sample([0, 0, 0])[0], 1 / 16);
    near(grid.sample([4, 0, 0])[0], (1 + 2) / 2 / 16); // between two points of small cells
    near(grid.sample([16, 4, 0])[0], (0.75 * 9 + 0.25 * 11) / 16); // octants 1 and 3: points 0 and 2
    near(grid.sample([-50, -50, -50])[0], 1 / 16);
    near(grid.sample([24, 0, 0])[0], 9 / 16); // the other end lies outside of the roots
});

test('the legacy grid: light of one point, black points left out, bright ones keep their hue', () => {
    const point = (ambient, directed) => Uint8Array.of(...ambient, ...directed, 64, 0); // light from +x
    const world = { mins: [-64, -64, -128], maxs: [64, 64, 128] };
    const points = Array.from({ length: 27 }, (_, i) =>
        point(i % 3 === 0 ? [0, 0, 0] : [10 * (i % 3), 20, 200], [100, 50, 0]),
    );
    const grid = new LegacyGrid(bytesOf(...points), world, new Map());
    assert.deepEqual(grid.bounds, [3, 3, 3]);
    const light = grid.sample([0, 0, 0], 1);
    assert.deepEqual(light.ambient, [12, 25, 255]); // 20 40 400, scaled down to 255
    assert.deepEqual(light.directed, [200, 100, 0]);
    near(light.direction[0], 1);
    assert.deepEqual(grid.sample([-32, 0, 0], 0).ambient, [10, 20, 200]); // one side is black
    assert.throws(() => new LegacyGrid(new Uint8Array(8), world, new Map()), /holds 1 points, the world needs 27/);
});

test('the legacy grid with light styles: their light is added up, points without a style are left out', () => {
    const lumps = styledLumps([0, 1, -3, -3], 2, '"gridsize" "64 64 128"');
    const lit = (style, ambient, directed) => ({ style, ambient, directed });
    lumps[15] = bytesOf(
        gridRecord(lit(0, [10, 20, 200], [100, 50, 0]), lit(33, [40, 0, 0], [0, 60, 0])),
        gridRecord(), // in a wall
        gridRecord(lit(5, [80, 0, 0], [0, 0, 0])),
    );
    const numbers = Array.from({ length: 75 }, (_, i) => (i % 5 === 0 ? 1 : 0)); // 5 x 5 x 3 points
    numbers[74] = 3; // past the records
    lumps[17] = u16(...numbers);
    const read = () => readGrids(readMap(makeBsp(1, lumps, [], 'RBSP')));
    const { legacy, problems } = read();
    assert.deepEqual([legacy.bounds, legacy.outside], [[5, 5, 3], 1]);
    assert.match(problems[0], /^1 of 75 points of the legacy light grid name no light\.$/);
    assert.deepEqual(legacy.styles, [33, 5]);
    const { ambient, directed, direction } = legacy.sample([0, 0, 0], 0);
    assert.deepEqual([ambient, directed], [[10, 20, 200], [100, 50, 0]]);
    near(direction[0], 1);
    legacy.styleLight[33] = 0.5;
    assert.deepEqual(legacy.point(1).ambient, [30, 20, 200]);
    assert.deepEqual(legacy.point(1).directed, [100, 80, 0]);
    legacy.styleLight[0] = 0;
    assert.deepEqual(legacy.sample([-96, 0, 0], 0).ambient, [20, 0, 0]); // half of the weight is in a wall
    assert.deepEqual([legacy.point(74).ambient, legacy.point(74).directed], [[0, 0, 0], [0, 0, 0]]);
    lumps[17] = u16(...numbers.slice(1));
    assert.match(read().problems[0], /holds 74 points, the world needs 75/);
    lumps[17] = u16(...numbers);
    lumps[15] = lumps[15].subarray(1);
    assert.match(read().problems[0], /whole records/);
});

test('models get ambient light times 0.6, and the minimum', () => {
    const sample = { ambient: [100, 50, 0], directed: [60, 100, 20], direction: [0, 0, 1] };
    modelLight(sample, 16).ambient.forEach((c, i) => near(c, [76, 46, 16][i]));
    assert.deepEqual(modelLight(sample, 16).directed, [60, 100, 20]);
});

test('radiance is convolved on reading', () => {
    const lumps = roomLumps();
    lumps[0] = bytesOf('{ "classname" "worldspawn" "_q3map2_sh" "radiance" }\0');
    const lump = uniformLump([0, 0, 0], [32, 32, 64], [1, 1, 1], () => 1);
    const { uniform } = readGrids(readMap(makeBsp(46, lumps, [['LIGHTGRID_SH', lump]])));
    near(uniform.coeffs(0)[0], Math.PI);
    near(uniform.sample([0, 0, 0])[3], (2 * Math.PI) / 3);
    near(uniform.sample([0, 0, 0])[26], Math.PI / 4);
});

test('tone', () => {
    assert.deepEqual(parseTone('gamma 1.4 scale 0.25').tone, {
        contrast: 1,
        gamma: 1.4,
        exposure: 0,
        saturation: 1,
        scale: 0.25,
        maxlight: 255,
        srgb: 0,
    });
    assert.equal(parseTone(undefined).valid, true);
    assert.equal(parseTone('gamma').valid, false);
    assert.equal(parseTone('gamma 0').valid, false);
    assert.equal(parseTone('unknown 3 gamma 2').tone.gamma, 2);
});
