// GPL-2.0-or-later. The SH light grid of points at equal distances: lump 18 or the BSPX lump LIGHTGRID_SH.
import { expect, float32s, int32s } from './bytes.js';
import { Lattice } from './lattice.js';

const kHeaderBytes = 40;
const kPointFloats = 27;

/** Whole part and fraction of a position on an axis of points, clamped to the grid. */
export function gridAxis(position, mins, size, count) {
    let at = (position - mins) / size;
    if (!(at > 0)) at = 0; // NaN too
    if (at > count - 1) at = count - 1;
    const low = Math.floor(at);
    return { low, fraction: at - low };
}

export class UniformGridSH extends Lattice {
    /**
     * @param {Uint8Array} lump
     * @throws FormatError if it contradicts itself
     */
    constructor(lump) {
        super();
        expect(lump.length >= kHeaderBytes, 'The SH light grid ends in its header.');
        const head = float32s(lump.subarray(0, 24));
        this.mins = [...head.subarray(0, 3)];
        this.cell = [...head.subarray(3, 6)];
        const [nx, ny, nz, count] = int32s(lump.subarray(24, kHeaderBytes));
        this.bounds = [nx, ny, nz];
        this.count = count;
        expect(this.mins.every(Number.isFinite), 'The SH light grid begins at a position that is no number.');
        expect(
            this.cell.every((size) => Number.isFinite(size) && size > 0),
            'The SH light grid has cells without size.',
        );
        expect(
            this.bounds.every((n) => n >= 1),
            'The SH light grid has less than one point on an axis.',
        );
        expect(
            BigInt(nx) * BigInt(ny) * BigInt(nz) === BigInt(count) &&
                lump.length === kHeaderBytes + 4 * kPointFloats * count,
            `The SH light grid says that it has ${nx} x ${ny} x ${nz} points, which its lump does not hold.`,
        );
        this.values = float32s(lump.subarray(kHeaderBytes));
        expect(this.values.every(Number.isFinite), 'The SH light grid holds coefficients that are no numbers.');
    }

    /** 27 coefficients of point i: nine of red, green, blue. */
    coeffs(i, out = new Float32Array(kPointFloats)) {
        out.set(this.values.subarray(kPointFloats * i, kPointFloats * (i + 1)));
        return out;
    }

    /** Trilinear blend at a position; positions outside are clamped to the grid. */
    sample(position) {
        const axes = [0, 1, 2].map((i) => gridAxis(position[i], this.mins[i], this.cell[i], this.bounds[i]));
        const sum = new Float32Array(kPointFloats);
        for (let corner = 0; corner < 8; corner++) {
            let weight = 1;
            const at = axes.map(({ low, fraction }, axis) => {
                const upper = (corner >> axis) & 1;
                weight *= upper ? fraction : 1 - fraction;
                return low + upper;
            });
            if (!(weight > 0)) continue; // past the far border
            const first = kPointFloats * (at[0] + this.bounds[0] * (at[1] + this.bounds[1] * at[2]));
            for (let k = 0; k < kPointFloats; k++) sum[k] += weight * this.values[first + k];
        }
        return sum;
    }
}
