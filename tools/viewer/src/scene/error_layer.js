// GPL-2.0-or-later. Errors of a grid at positions in a horizontal slice.
import { DotsLayer } from './dots_layer.js';

/** Colors of the scale from no error to the largest, evenly apart. */
export const kErrorScale = ['#2b2f77', '#2f6fb3', '#2fa8a0', '#7ccb63', '#f3e35a', '#f59b3d', '#e0403a'];

const kRadius = 3; // of a dot, units

export class ErrorLayer {
    /** From parseErrors; null: none. */
    errors = null;
    dots = new DotsLayer(kErrorScale);

    /** @param errors from parseErrors; null: none */
    set(errors) {
        this.errors = errors;
        const values = errors ? [errors.sh, errors.legacy].filter(Boolean) : [];
        this.dots.set(errors?.positions ?? new Float32Array(), values, { radius: kRadius });
    }

    /**
     * @param {'off'|'sh'|'legacy'} show
     * @returns number of the positions in the slice and root mean square of their errors; null if nothing is shown
     */
    update(show, { height, thickness, largest }) {
        const [low, high] = [height - thickness / 2, height + thickness / 2];
        return this.dots.show(this.errors?.[show] ?? null, { least: 0, largest, low, high });
    }
}
