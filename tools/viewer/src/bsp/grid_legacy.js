// GPL-2.0-or-later. The legacy light grid, lump 15, as ioquake3 reads and interpolates it.
import { expect } from './bytes.js';
import { parseVector } from './entities.js';
import { Lattice } from './lattice.js';

const kPointBytes = 8;
const kAmbientScale = 0.6; // default of r_ambientScale

/** Brightens a color by `shift` bits and scales it down to 255 if it is too bright, as ioquake3 does on loading. */
export function shiftColor(color, shift) {
    const shifted = color.map((c) => c << shift);
    const most = Math.max(...shifted);
    return most > 255 ? shifted.map((c) => Math.floor((c * 255) / most)) : shifted;
}

/**
 * Light of a model as ioquake3 makes it from a sample of the grid: its ambient light is scaled and raised.
 * @param {number} minimum added to ambient light, bytes
 */
export function modelLight(sample, minimum) {
    return { ...sample, ambient: sample.ambient.map((c) => kAmbientScale * c + minimum) };
}

/** The direction of two angles in bytes, as ioquake3 reads them: from +z, and around z. */
export function directionOf(fromUp, around) {
    const longitude = (fromUp * 2 * Math.PI) / 256;
    const latitude = (around * 2 * Math.PI) / 256;
    return [
        Math.cos(latitude) * Math.sin(longitude),
        Math.sin(latitude) * Math.sin(longitude),
        Math.cos(longitude),
    ];
}

/** A grid whose lattice is that of the world's bounds. Classes below have `point` and `isInWall`. */
export class LegacyLattice extends Lattice {
    /** Light styles other than 0. */
    styles = [];

    /**
     * @param {number} points how many the file has
     * @param {{mins: number[], maxs: number[]}} world model 0
     * @param {Map<string, string>} worldspawn
     * @throws FormatError if the world needs another number of points
     */
    constructor(points, world, worldspawn) {
        super();
        this.cell = parseVector(worldspawn?.get('gridsize')) ?? [64, 64, 128];
        this.mins = this.cell.map((size, i) => size * Math.ceil(world.mins[i] / size));
        this.bounds = this.cell.map((size, i) => (size * Math.floor(world.maxs[i] / size) - this.mins[i]) / size + 1);
        this.count = this.bounds[0] * this.bounds[1] * this.bounds[2];
        expect(points === this.count, `The legacy light grid holds ${points} points, the world needs ${this.count}.`);
    }

    /**
     * Ambient and directed light as ioquake3 blends them: points in walls are left out, and the lower corner alone is
     * clamped to the grid, so that weights outside of it are those of the unclamped position.
     * @param {number} shift bits of overbright, r_mapOverBrightBits - r_overBrightBits
     */
    sample(position, shift) {
        const at = position.map((p, i) => (p - this.mins[i]) / this.cell[i]);
        const fraction = at.map((n) => n - Math.floor(n));
        const low = at.map((n, i) => Math.min(Math.max(Math.floor(n), 0), this.bounds[i] - 1));
        const light = { ambient: [0, 0, 0], directed: [0, 0, 0], direction: [0, 0, 0] };
        let total = 0;
        for (let corner = 0; corner < 8; corner++) {
            const upper = [0, 1, 2].map((axis) => (corner >> axis) & 1);
            const index = low.map((n, axis) => n + upper[axis]);
            if (index.some((n, axis) => n > this.bounds[axis] - 1)) continue;
            const i = index[0] + this.bounds[0] * (index[1] + this.bounds[1] * index[2]);
            if (this.isInWall(i)) continue;
            const point = this.point(i);
            const ambient = shiftColor(point.ambient, shift);
            const directed = shiftColor(point.directed, shift);
            const weight = upper.reduce((product, up, axis) => product * (up ? fraction[axis] : 1 - fraction[axis]), 1);
            total += weight;
            for (let k = 0; k < 3; k++) {
                light.ambient[k] += weight * ambient[k];
                light.directed[k] += weight * directed[k];
                light.direction[k] += weight * point.direction[k];
            }
        }
        return finish(light, total);
    }
}

/** The grid of IBSP: points in the order of the lattice, black ones in walls. */
export class LegacyGrid extends LegacyLattice {
    /** The first parameter is lump 15; others and errors as above. */
    constructor(lump, world, worldspawn) {
        super(lump.length / kPointBytes, world, worldspawn);
        this.bytes = lump;
    }

    isInWall(i) {
        const at = kPointBytes * i;
        return this.bytes[at] + this.bytes[at + 1] + this.bytes[at + 2] === 0;
    }

    /** Ambient and directed light in bytes, direction to the light. */
    point(i) {
        const at = kPointBytes * i;
        return {
            ambient: [...this.bytes.subarray(at, at + 3)],
            directed: [...this.bytes.subarray(at + 3, at + 6)],
            direction: directionOf(this.bytes[at + 6], this.bytes[at + 7]),
        };
    }
}

function finish(light, total) {
    if (total > 0 && total < 0.99)
        for (let i = 0; i < 3; i++) {
            light.ambient[i] /= total;
            light.directed[i] /= total;
        }
    const length = Math.hypot(...light.direction);
    if (length > 0) light.direction = light.direction.map((d) => d / length);
    return light;
}
