// GPL-2.0-or-later. Grids that the program bakes, as this page, the program's JSON and the reader for engines see them.
// PROGRAM names q3map2, PROBE the compiled probe.c.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { appendFileSync, cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { readGrids } from '../../src/bsp/grids.js';
import { colorField, lightmapField, readMap } from '../../src/bsp/map.js';

const { PROGRAM, PROBE } = process.env;
const kArena = join(import.meta.dirname, '../../../demo_data/demo_arena');
const skip = PROGRAM && PROBE ? false : 'PROGRAM and PROBE are not set';
let folder;
let bsp;
let styled; // the same arena for a game with RBSP files, with a lamp of another style

before(() => {
    if (skip) return;
    folder = mkdtempSync(join(tmpdir(), 'viewer-readers-'));
    cpSync(kArena, join(folder, 'demo'), { recursive: true });
    const run = (...options) => execFileSync(PROGRAM, ['-fs_basepath', folder, '-fs_basegame', 'demo', ...options]);
    run('-meta', join(folder, 'demo/maps/demo.map'));
    bsp = join(folder, 'demo/maps/demo.bsp');
    run('-vis', bsp);
    run('-light', '-fast', '-shbspx', '-shadaptive', bsp);
    run('-json', '-unpack', bsp);
    cpSync(kArena, join(folder, 'ja'), { recursive: true });
    cpSync(join(kArena, 'scripts'), join(folder, 'ja/shaders'), { recursive: true });
    const map = join(folder, 'ja/maps/demo.map');
    appendFileSync(map, '{ "classname" "light" "origin" "-264 0 100" "light" "300" "targetname" "lamp" }\n');
    const runStyled = (...options) =>
        execFileSync(PROGRAM, ['-game', 'ja', '-fs_basepath', folder, '-fs_basegame', 'ja', ...options]);
    styled = join(folder, 'ja/maps/demo.bsp');
    runStyled('-meta', map);
    runStyled('-light', '-fast', '-shbspx', styled);
    runStyled('-json', '-unpack', styled);
});

after(() => folder && rmSync(folder, { recursive: true }));

const grids = (path = bsp) => readGrids(readMap(new Uint8Array(readFileSync(path))));

/** Coefficients by the reader for engines. */
function probe(form, positions, path = bsp) {
    const input = positions.map((p) => `${p.map((c) => Math.fround(c)).join(' ')} 0 0 1`).join('\n');
    const output = execFileSync(PROBE, [path, form], { input, maxBuffer: 1 << 28 });
    return output
        .toString()
        .trim()
        .split('\n')
        .map((line) => line.split(' ').map(Number));
}

test('points of the uniform grid equal those of the JSON', { skip }, () => {
    const json = JSON.parse(readFileSync(join(folder, 'demo/maps/demo/GridPointsSH.json'), 'utf8'));
    const { uniform } = grids();
    assert.equal(uniform.count, json.points.length);
    assert.deepEqual(
        uniform.mins.map((c) => c + 0),
        json.header.gridMins.map((c) => c + 0),
    );
    json.points.forEach((point, i) => assert.deepEqual([...uniform.coeffs(i)], point.flat().map(Math.fround)));
});

test('points of the legacy grid equal those of the JSON', { skip }, () => {
    const json = Object.values(JSON.parse(readFileSync(join(folder, 'demo/maps/demo/GridPoints.json'), 'utf8')));
    const { legacy } = grids();
    assert.equal(legacy.count, json.length);
    json.forEach((point, i) =>
        assert.deepEqual([legacy.point(i).ambient, legacy.point(i).directed], [point.ambient[0], point.directed[0]]),
    );
});

for (const form of ['uniform', 'sparse'])
    test(`samples of the ${form} grid equal those of the reader for engines`, { skip }, () => {
        const grid = grids()[form];
        let seed = 1;
        const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
        const positions = Array.from({ length: 3000 }, () =>
            grid.mins.map((low, i) => Math.fround(low + (1.1 * random() - 0.05) * grid.bounds[i] * grid.cell[i])),
        );
        probe(form, positions).forEach((expected, i) => {
            const actual = grid.sample(positions[i]);
            const size = 1e-5 + Math.max(...expected.slice(0, 3).map(Math.abs));
            for (let k = 0; k < 27; k++)
                assert.ok(
                    Math.abs(actual[k] - expected[k]) < 1e-4 * size,
                    `at ${positions[i]}, value ${k}: ${actual[k]} is not ${expected[k]}`,
                );
        });
    });

test('stored points of the sparse grid have the values of the reader for engines', { skip }, () => {
    const { sparse } = grids();
    const positions = Array.from({ length: sparse.count }, (_, i) => sparse.position(i));
    probe('sparse', positions).forEach((expected, i) => {
        const actual = sparse.coeffs(i);
        for (let k = 0; k < 27; k++) assert.ok(Math.abs(actual[k] - expected[k]) < 1e-5 * (1 + Math.abs(expected[0])));
    });
});

test('an RBSP map: light of all styles equals the JSON', { skip }, () => {
    const records = (name) => Object.values(JSON.parse(readFileSync(styled.replace('.bsp', `/${name}.json`), 'utf8')));
    const map = readMap(new Uint8Array(readFileSync(styled)));
    assert.equal(map.ident, 'RBSP');
    assert.deepEqual(map.styles, [32]);
    const used = (styles) => styles.filter((style) => style < 254);
    records('DrawSurfaces').forEach((record, i) => {
        const { lightmapStyles, vertexStyles, pages } = map.surfaces[i];
        assert.deepEqual(
            [lightmapStyles, vertexStyles, pages],
            [used(record.lightmapStyles), used(record.vertexStyles), record.lightmapNum],
        );
    });
    records('DrawVert').forEach((record, i) =>
        [0, 1, 2, 3].forEach((slot) => {
            const of = (field, size) => [...map.vertices[field].subarray(size * i, size * (i + 1))];
            assert.deepEqual(of(lightmapField(slot), 2), record.lightmap[slot].map(Math.fround));
            assert.deepEqual(of(colorField(slot), 4), record.color[slot]);
        }),
    );
    const { legacy, problems } = grids(styled);
    assert.deepEqual([legacy.styles, problems], [[32], []]);
    const points = records('GridPoints');
    assert.equal(legacy.count, points.length);
    for (const style of [0, 32]) {
        legacy.styleLight.fill(0);
        legacy.styleLight[style] = 1;
        points.forEach(({ ambient, directed, styles }, i) => {
            const slot = styles.indexOf(style);
            const expected = slot < 0 ? [[0, 0, 0], [0, 0, 0]] : [ambient[slot], directed[slot]];
            if (styles[0] !== 255) assert.deepEqual([legacy.point(i).ambient, legacy.point(i).directed], expected);
        });
    }
});

test('an RBSP map: the SH grid is that of the reader for engines', { skip }, () => {
    const { uniform } = grids(styled);
    const positions = Array.from({ length: uniform.count }, (_, i) => uniform.position(i));
    probe('uniform', positions, styled).forEach((expected, i) => {
        const actual = uniform.coeffs(i);
        for (let k = 0; k < 27; k++) assert.ok(Math.abs(actual[k] - expected[k]) < 1e-4 * (1 + Math.abs(expected[0])));
    });
    assert.ok(positions.some((_, i) => uniform.coeffs(i)[0] > 0.1));
});
