// GPL-2.0-or-later. Points of a light grid as spheres, near the viewer or in a slice.
import { kMapShift } from './glsl.js';
import { shiftColor } from '../bsp/grid_legacy.js';
import { Spheres, SphereMode } from './spheres.js';

const kMostSpheres = 20000;
const kRadius = 0.11; // of a sphere, in edges of its cell
const kNearest = 4; // radii from the viewer: nearer spheres would hide the view

/** What a point is: in the open, in a wall with light that was filled in, or without light. */
export const Kind = { lit: 0, filled: 1, void: 2 };
export const kKindColors = [
    [0.93, 0.78, 0.35],
    [0.33, 0.62, 0.88],
    [0.32, 0.32, 0.36],
];

/** Colors of levels of a sparse grid, smallest cells first. */
export const kLevelColors = [
    [0.95, 0.86, 0.36],
    [0.97, 0.62, 0.31],
    [0.91, 0.38, 0.37],
    [0.74, 0.3, 0.52],
    [0.5, 0.31, 0.62],
    [0.31, 0.38, 0.68],
    [0.23, 0.52, 0.66],
    [0.25, 0.66, 0.58],
    [0.45, 0.76, 0.46],
    [0.66, 0.82, 0.4],
    [0.8, 0.8, 0.8],
    [0.5, 0.5, 0.5],
];

/** Light of legacy point i as the shader of spheres takes it: shifted ambient and directed light, direction. */
function legacyValues(grid, i) {
    const point = grid.point(i);
    const share = (color) => shiftColor(color, kMapShift).map((c) => c / 255);
    return [...share(point.ambient), ...share(point.directed), ...point.direction];
}

/** Square of the distance of a point from the viewer. */
function distance2(viewer, x, y, z) {
    return (x - viewer[0]) ** 2 + (y - viewer[1]) ** 2 + (z - viewer[2]) ** 2;
}

/** A squared distance below which at most kMostSpheres of the points lie, as many as a histogram can tell. */
function nearestLimit(distances, largest) {
    const bins = new Int32Array(1024);
    for (const distance of distances) bins[Math.min(Math.floor((distance / largest) * bins.length), bins.length - 1)]++;
    let [bin, sum] = [0, 0];
    while (bin < bins.length && sum + bins[bin] <= kMostSpheres) sum += bins[bin++];
    return (bin / bins.length) * largest;
}

export class GridLayer {
    /** Points in reach, and how many of them are shown. */
    counts = { near: 0, shown: 0 };
    /** Shown points by kind. */
    kinds = [0, 0, 0];

    constructor(lightUniforms) {
        this.spheres = new Spheres(kMostSpheres, lightUniforms);
        this.scratch = new Float32Array(27);
    }

    get mesh() {
        return this.spheres.mesh;
    }

    /** Values of point i for the shader, and its kind. */
    read(grid, tree, legacy, i, x, y, z) {
        const values = legacy ? legacyValues(grid, i) : grid.coeffs(i, this.scratch);
        const dark = legacy ? values.slice(0, 6).every((v) => v === 0) : values.every((v) => v === 0);
        const solid = tree.clusterAt(x, y, z) < 0;
        return { values, kind: !solid ? Kind.lit : dark ? Kind.void : Kind.filled };
    }

    /** Numbers of the points in reach; of the nearest if there are more than can be shown. */
    select(grid, { viewer, where, radius, height, thickness }) {
        const low = viewer.map((c) => c - radius);
        const high = viewer.map((c) => c + radius);
        if (where === 'slice') {
            low[2] = height - thickness / 2;
            high[2] = height + thickness / 2;
        }
        const points = [];
        const distances = [];
        grid.forEachIn(low, high, (i, x, y, z) => {
            const distance = distance2(viewer, x, y, where === 'slice' ? viewer[2] : z);
            if (distance > radius * radius) return;
            points.push(i);
            distances.push(distance);
        });
        this.counts.near = points.length;
        if (points.length <= kMostSpheres) return points;
        const limit = nearestLimit(distances, radius * radius);
        return points.filter((_, k) => distances[k] < limit);
    }

    /**
     * Chooses the points anew.
     * @param grid a uniform, sparse or legacy grid; null: none
     * @param tree the map's BspTree
     * @param options viewer (position), where ('near' or 'slice'), radius, height and thickness in units; size, factor
     *   of the spheres; color ('light', 'kind' or 'level'); openOnly leaves out points in solid space
     */
    update(grid, tree, options) {
        this.spheres.clear();
        this.counts = { near: 0, shown: 0 };
        this.kinds = [0, 0, 0];
        if (!grid) return;
        const legacy = 'point' in grid;
        for (const i of this.select(grid, options)) {
            const [x, y, z] = grid.position(i);
            const radius = kRadius * options.size * grid.size(i);
            const { values, kind } = this.read(grid, tree, legacy, i, x, y, z);
            this.kinds[kind]++;
            if (options.openOnly && kind !== Kind.lit) continue;
            if (distance2(options.viewer, x, y, z) < (kNearest * radius) ** 2) continue;
            const tint = options.color === 'level' ? kLevelColors[grid.level(i)] : kKindColors[kind];
            this.spheres.add(x, y, z, radius, tint, values);
        }
        this.counts.shown = this.spheres.count;
        this.spheres.commit(options.color !== 'light' ? SphereMode.tint : legacy ? SphereMode.legacy : SphereMode.sh);
    }
}
