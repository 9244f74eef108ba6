// GPL-2.0-or-later. Which surfaces positions lie on.

const kCell = 64; // units
const kBehind = 0.5; // units behind a triangle at which a position is on its other side

const difference = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const along = (u, scale, v) => [u[0] + scale * v[0], u[1] + scale * v[1], u[2] + scale * v[2]];
const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];

const cellOf = (x) => Math.floor(x / kCell) + 32768;
const keyOf = (x, y, z) => (x * 65536 + y) * 65536 + z;

/** Numbers of the positions in each cell of space. */
function cellsOf(positions) {
    const cells = new Map();
    for (let i = 0; i < positions.length / 3; i++) {
        const key = keyOf(...[0, 1, 2].map((axis) => cellOf(positions[3 * i + axis])));
        if (!cells.has(key)) cells.set(key, []);
        cells.get(key).push(i);
    }
    return cells;
}

/** Lists of the positions in the cells of a box. */
function* listsIn(cells, low, high) {
    const [first, last] = [low.map(cellOf), high.map(cellOf)];
    if (first.reduce((size, c, axis) => size * (last[axis] - c + 1), 1) > cells.size) {
        yield* cells.values();
        return;
    }
    for (let x = first[0]; x <= last[0]; x++)
        for (let y = first[1]; y <= last[1]; y++)
            for (let z = first[2]; z <= last[2]; z++) {
                const list = cells.get(keyOf(x, y, z));
                if (list) yield list;
            }
}

/** The point of the edge from a to b that is nearest to p. */
function nearestOnEdge(p, a, b) {
    const edge = difference(b, a);
    return along(a, Math.min(Math.max(dot(difference(p, a), edge) / dot(edge, edge) || 0, 0), 1), edge);
}

/** The point of a triangle, whose normal is given, that is nearest to p. */
function nearestOnTriangle(p, corners, normal) {
    const inPlane = along(p, -dot(difference(p, corners[0]), normal), normal);
    const edges = [0, 1, 2].map((k) => [corners[k], corners[(k + 1) % 3]]);
    const isInside = ([a, b]) => dot(cross(difference(b, a), difference(inPlane, a)), normal) >= 0;
    if (edges.every(isInside)) return inPlane;
    const distance = (q) => Math.hypot(...difference(p, q));
    return edges.map(([a, b]) => nearestOnEdge(p, a, b)).reduce((q, r) => (distance(r) < distance(q) ? r : q));
}

/**
 * Moves positions onto the triangles nearest to them.
 * @param {Float32Array} positions three numbers each
 * @param {{vertices: Float32Array, indexes: Uint32Array}[]} meshes of triangles that turn clockwise as seen from the front
 * @param {number} reach units from a position to a triangle that it may lie on
 * @returns {{positions: Float32Array, normals: Float32Array}} normals on the side where the position was; a position
 *     that is near no triangle stays where it is, with a normal of zero
 */
export function ontoSurfaces(positions, meshes, reach) {
    const found = { positions: positions.slice(), normals: new Float32Array(positions.length) };
    const least = new Float32Array(positions.length / 3).fill(reach);
    const cells = cellsOf(positions);
    const tryTriangle = (corners) => {
        const outward = cross(difference(corners[2], corners[0]), difference(corners[1], corners[0]));
        const length = Math.hypot(...outward);
        if (!(length > 0)) return;
        const normal = outward.map((c) => c / length);
        const inward = normal.map((c) => -c); // around which the corners turn counterclockwise
        const low = [0, 1, 2].map((axis) => Math.min(...corners.map((corner) => corner[axis])) - reach);
        const high = [0, 1, 2].map((axis) => Math.max(...corners.map((corner) => corner[axis])) + reach);
        for (const list of listsIn(cells, low, high))
            for (const i of list) {
                const p = positions.subarray(3 * i, 3 * i + 3);
                const height = dot(difference(p, corners[0]), normal);
                if (Math.abs(height) >= least[i] || p.some((c, axis) => c < low[axis] || c > high[axis])) continue;
                const nearest = nearestOnTriangle(p, corners, inward);
                const distance = Math.hypot(...difference(p, nearest));
                if (distance >= least[i]) continue;
                least[i] = distance;
                found.positions.set(nearest, 3 * i);
                found.normals.set(height < -kBehind ? inward : normal, 3 * i);
            }
    };
    for (const { vertices, indexes } of meshes)
        for (let i = 0; i < indexes.length; i += 3)
            tryTriangle([0, 1, 2].map((k) => vertices.subarray(3 * indexes[i + k], 3 * indexes[i + k] + 3)));
    return found;
}
