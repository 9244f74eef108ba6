// GPL-2.0-or-later. Files beside a map: leak lines (.lin), portals (.prt), errors of grids (.sherror.json).
import { expect } from './bytes.js';

/**
 * Points of a leak line.
 * @param {string} text lines of "x y z"
 * @returns {number[][]}
 */
export function parseLeakLine(text) {
    const points = text
        .split('\n')
        .map((line) => line.trim())
        .filter((line) => line !== '')
        .map((line) => line.split(/\s+/).map(Number));
    expect(
        points.length >= 2 && points.every((p) => p.length === 3 && p.every(Number.isFinite)),
        'The .lin file is not lines of three numbers.',
    );
    return points;
}

/**
 * Portals between clusters, without the faces of solids.
 * @param {string} text a PRT1 file
 * @returns {{clusters: number, portals: {points: number[][], clusters: number[], hint: boolean}[]}}
 */
export function parsePortals(text) {
    const words = text.replace(/[()]/g, ' ').trim().split(/\s+/);
    expect(words[0] === 'PRT1', 'The .prt file does not begin with PRT1.');
    let at = 1;
    const number = () => {
        const value = Number(words[at++] ?? NaN);
        expect(
            Number.isFinite(value),
            `The .prt file ends early or has a word that is no number, "${words[at - 1] ?? ''}".`,
        );
        return value;
    };
    const [clusters, count] = [number(), number()];
    number(); // faces
    const portals = [];
    for (let i = 0; i < count; i++) {
        const size = number();
        expect(size >= 3 && size <= 1024, `Portal ${i} of the .prt file has ${size} points.`);
        const sides = [number(), number()];
        const flags = number();
        portals.push({
            clusters: sides,
            hint: (flags & 1) !== 0,
            points: Array.from({ length: size }, () => [number(), number(), number()]),
        });
    }
    return { clusters, portals };
}

/**
 * Errors of both grids at positions, in displayed bytes.
 * @param {string} text JSON, see docs/viewer.md
 * @returns name of the map, unit, count, and Float32Arrays: positions (three values each), sh, legacy (null if a
 *     position has none)
 */
export function parseErrors(text) {
    let json;
    try {
        json = JSON.parse(text);
    } catch {
        expect(false, 'The file of errors is no valid JSON.');
    }
    expect(
        json?.format === 'q3map2-sh errors' && json.version === 1 && Array.isArray(json.positions),
        'The file of errors is not "q3map2-sh errors" of version 1.',
    );
    const rows = json.positions;
    const hasLegacy = rows.every((row) => row?.[4] !== null);
    const isNumber = (value, i) => Number.isFinite(value) || (i === 4 && !hasLegacy && value === null);
    expect(
        rows.every((row) => Array.isArray(row) && row.length === 5 && row.every(isNumber)),
        'The file of errors has a position that is not five numbers.',
    );
    return {
        map: String(json.map ?? ''),
        unit: String(json.unit ?? 'displayed bytes'),
        count: rows.length,
        positions: Float32Array.from(rows.flatMap((row) => row.slice(0, 3))),
        sh: Float32Array.from(rows, (row) => row[3]),
        legacy: hasLegacy ? Float32Array.from(rows, (row) => row[4]) : null,
    };
}
