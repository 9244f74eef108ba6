// GPL-2.0-or-later. Light of luxels that no known source and no lamp that was found explains, on the surfaces.
import { DotsLayer } from './dots_layer.js';
import { ontoSurfaces } from './nearest_surface.js';

/** Colors of the scale from darker than explained to lighter, evenly apart; what is explained hardly shows. */
export const kUnexplainedScale = [
    '#1440ffff',
    '#2f7dffd8',
    '#6ab0ff60',
    '#d0d0d010',
    '#ff967860',
    '#ff5c34d8',
    '#ff1f0aff',
];

const kReach = 8; // units from a luxel to the triangle that it may lie on: curves are drawn with few triangles
const kShare = 0.36; // radius of a dot in distances between luxels
const [kLeastRadius, kLargestRadius] = [1.5, 16]; // units
const kFar = 1e6; // units, beyond every map; shaders may not have infinity
const kProbes = 200; // luxels whose nearest neighbor is searched

/** The usual distance from a luxel to the nearest other one, units. */
function spacingOf(positions) {
    const count = positions.length / 3;
    const probes = Math.min(count, kProbes);
    const distances = Array.from({ length: probes }, (_, k) => {
        const i = 3 * Math.floor((k * count) / probes);
        let least = Infinity;
        for (let j = 0; j < positions.length; j += 3) {
            const [x, y, z] = [0, 1, 2].map((axis) => positions[i + axis] - positions[j + axis]);
            const distance = x * x + y * y + z * z;
            if (j !== i && distance < least) least = distance;
        }
        return Math.sqrt(least);
    });
    return distances.sort((a, b) => a - b)[probes >> 1] ?? 0;
}

export class UnexplainedLayer {
    /** From parseUnexplained; null: none. */
    light = null;
    dots = new DotsLayer(kUnexplainedScale);

    /**
     * @param light from parseUnexplained; null: none
     * @param {{vertices: Float32Array, indexes: Uint32Array}[]} meshes of the map, which the luxels are on
     */
    set(light, meshes = []) {
        this.light = light;
        const { positions, normals } = ontoSurfaces(light?.positions ?? new Float32Array(), meshes, kReach);
        const radius = Math.min(Math.max(kShare * spacingOf(positions), kLeastRadius), kLargestRadius);
        this.dots.set(positions, light ? [light.light] : [], { radius, normals });
    }

    /**
     * @param {boolean} isShown
     * @param {number} largest end of the scale on both sides
     * @param {number|null} top height above which the map is cut
     * @returns number of the luxels and root mean square of their unexplained light; null if nothing is shown
     */
    update(isShown, largest, top) {
        const values = isShown && this.light ? this.light.light : null;
        return this.dots.show(values, { least: -largest, largest, low: -kFar, high: top ?? kFar });
    }
}
