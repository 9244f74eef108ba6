// GPL-2.0-or-later. Files beside a map: leak lines (.lin), portals (.prt), errors of grids (.sherror.json), light that
// no lamp explains (.unexplained.json), and explanations of its light (.explain.json).
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

/** The object in a file of JSON. `what` names it in messages: "file of errors". */
function parseFormat(text, what, format) {
    let json;
    try {
        json = JSON.parse(text);
    } catch {
        expect(false, `The ${what} is no valid JSON.`);
    }
    expect(json?.format === format && json.version === 1, `The ${what} is not "${format}" of version 1.`);
    return json;
}

/**
 * The rows of `positions` in a file of JSON.
 * @param {string} size of a row, as a word
 * @param {(row: unknown) => boolean} isRow
 */
function rowsOf(json, what, size, isRow) {
    expect(Array.isArray(json.positions), `The ${what} has no positions.`);
    expect(json.positions.every(isRow), `The ${what} has a position that is not ${size} numbers.`);
    return json.positions;
}

const placesOf = (rows) => Float32Array.from(rows.flatMap((row) => row.slice(0, 3)));

/**
 * Errors of both grids at positions, in displayed bytes.
 * @param {string} text JSON, see docs/guide/viewer.md
 * @returns name of the map, unit, count, and Float32Arrays: positions (three values each), sh, legacy (null if a
 *     position has none)
 */
export function parseErrors(text) {
    const json = parseFormat(text, 'file of errors', 'q3map2-sh errors');
    const isNumber = (value, i) => Number.isFinite(value) || (i === 4 && value === null);
    const isRow = (row) => Array.isArray(row) && row.length === 5 && row.every(isNumber);
    const rows = rowsOf(json, 'file of errors', 'five', isRow);
    const hasLegacy = rows.every((row) => row[4] !== null);
    return {
        map: String(json.map ?? ''),
        unit: String(json.unit ?? 'displayed bytes'),
        count: rows.length,
        positions: placesOf(rows),
        sh: Float32Array.from(rows, (row) => row[3]),
        legacy: hasLegacy ? Float32Array.from(rows, (row) => row[4]) : null,
    };
}

/**
 * Light of luxels that is not explained, from `-recoverlights`.
 * @param {string} text JSON, see docs/guide/viewer.md
 * @returns name of the map, unit, count, and Float32Arrays: positions (three values each), light (stored less
 *     explained)
 */
export function parseUnexplained(text) {
    const what = 'file of unexplained light';
    const json = parseFormat(text, what, 'q3map2-sh unexplained light');
    const rows = rowsOf(
        json,
        what,
        'four',
        (row) => Array.isArray(row) && row.length === 4 && row.every(Number.isFinite),
    );
    return {
        map: String(json.map ?? ''),
        unit: String(json.unit ?? 'bytes'),
        count: rows.length,
        positions: placesOf(rows),
        light: Float32Array.from(rows, (row) => row[3]),
    };
}

/**
 * Explanations of places, from `-shreport -explain`.
 * @param {string} text JSON, see docs/guide/viewer.md
 * @returns {{map: string, options: string, places: Place[]}} options: of the light run that is explained
 *
 * @typedef {object} Place
 * @property {number[]} at where lights and grids are explained
 * @property {number[]} on the point of the surface in front of which it is
 * @property {string} text the report, as of `-explain`
 * @property {Ray[]} rays to the strongest lights
 *
 * @typedef {object} Ray
 * @property {number[]} to the light; of a sun the direction to it
 * @property {boolean} [sun]
 * @property {number} visible share of its light that arrives, 0 to 1
 * @property {number[][]} [stops] where the rest of it is stopped
 */
export function parseExplanations(text) {
    const json = parseFormat(text, 'file of explanations', 'q3map2-sh explanations');
    const isPoint = (p) => Array.isArray(p) && p.length === 3 && p.every(Number.isFinite);
    const isRay = ({ to, visible, stops = [] }) => isPoint(to) && Number.isFinite(visible) && stops.every(isPoint);
    const isPlace = (place) =>
        isPoint(place?.at) &&
        isPoint(place.on) &&
        typeof place.text === 'string' &&
        Array.isArray(place.rays) &&
        place.rays.every(isRay);
    expect(
        Array.isArray(json.places) && json.places.every(isPlace),
        'The file of explanations has a place that is not complete.',
    );
    return { map: String(json.map ?? ''), options: String(json.options ?? ''), places: json.places };
}
