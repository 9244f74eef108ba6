// GPL-2.0-or-later. Biquadratic Bezier patches as triangles.
import { kSlots, colorField, lightmapField } from './map.js';

const kFields = [
    ['position', 3],
    ['st', 2],
    ['normal', 3],
    ...Array.from({ length: kSlots }, (_, slot) => [
        [lightmapField(slot), 2],
        [colorField(slot), 4],
    ]).flat(),
];

/** Fields that these vertices have: name and number of values. */
export const fieldsOf = (vertices) => kFields.filter(([name]) => vertices[name]);

const kMostSteps = 32; // pieces of a curve
const kChordError = 0.5; // units between a curve and its pieces

/** How many pieces the curves of 3 control points along one direction need. */
function stepsAlong(position, triples) {
    let most = 0;
    for (const [a, b, c] of triples) {
        const bend = [0, 1, 2].map((k) => position[3 * a + k] - 2 * position[3 * b + k] + position[3 * c + k]);
        most = Math.max(most, Math.hypot(...bend));
    }
    // n equal steps of the parameter leave an error of bend / (4 n^2).
    return Math.min(Math.max(1, Math.ceil(Math.sqrt(most / (4 * kChordError)))), kMostSteps);
}

/** Triples of control points along rows (across = false) or columns of the patch. */
function curves(first, width, height, across) {
    const triples = [];
    const [lines, points] = across ? [width, height] : [height, width];
    const index = (line, i) => first + (across ? line + width * i : i + width * line);
    for (let line = 0; line < lines; line++)
        for (let i = 0; i + 2 < points; i += 2) triples.push([index(line, i), index(line, i + 1), index(line, i + 2)]);
    return triples;
}

/** Parameter of sample i along a side with `steps` pieces a curve: first control point and its three weights. */
function weightsAt(i, steps, points) {
    const curve = Math.min(Math.floor(i / steps), (points - 3) / 2);
    const t = i / steps - curve;
    return { first: 2 * curve, weights: [(1 - t) * (1 - t), 2 * t * (1 - t), t * t] };
}

/**
 * @param vertices those of the map
 * @param surface a patch
 * @returns arrays of the fields of its vertices, and indexes that begin at 0
 */
export function tessellate(vertices, surface) {
    const { firstVertex: first, patchWidth: width, patchHeight: height } = surface;
    const stepsX = stepsAlong(vertices.position, curves(first, width, height, false));
    const stepsY = stepsAlong(vertices.position, curves(first, width, height, true));
    const [columns, rows] = [((width - 1) / 2) * stepsX + 1, ((height - 1) / 2) * stepsY + 1];
    const out = { count: columns * rows };
    for (const [name, size] of fieldsOf(vertices)) out[name] = new Float32Array(size * out.count);
    for (let row = 0; row < rows; row++)
        for (let column = 0; column < columns; column++)
            blend(
                vertices,
                first,
                width,
                weightsAt(column, stepsX, width),
                weightsAt(row, stepsY, height),
                out,
                row * columns + column,
            );
    return { vertices: out, indexes: gridIndexes(columns, rows) };
}

function blend(vertices, first, width, along, across, out, target) {
    for (const [name, size] of fieldsOf(vertices))
        for (let j = 0; j < 3; j++)
            for (let i = 0; i < 3; i++) {
                const source = size * (first + along.first + i + width * (across.first + j));
                const weight = along.weights[i] * across.weights[j];
                for (let k = 0; k < size; k++) out[name][size * target + k] += weight * vertices[name][source + k];
            }
    const normal = out.normal.subarray(3 * target, 3 * target + 3);
    const length = Math.hypot(...normal);
    if (length > 0) for (let k = 0; k < 3; k++) normal[k] /= length;
}

function gridIndexes(columns, rows) {
    const indexes = [];
    for (let row = 0; row + 1 < rows; row++)
        for (let column = 0; column + 1 < columns; column++) {
            const a = row * columns + column;
            const [b, c, d] = [a + 1, a + columns, a + columns + 1];
            indexes.push(a, c, b, b, c, d);
        }
    return indexes;
}
