// GPL-2.0-or-later. All light grids of a map; one that is damaged is left out with a message.
import { FormatError } from './bytes.js';
import { Lump } from './container.js';
import { LegacyGrid } from './grid_legacy.js';
import { StyledGrid } from './grid_styled.js';
import { SparseGridSH } from './grid_sparse.js';
import { UniformGridSH } from './grid_uniform.js';
import { kConvolution } from './sh.js';

/** Makes a grid of radiance (-shradiance) return light on a matte surface, as other grids do. */
function convolved(grid) {
    const coeffs = grid.coeffs.bind(grid);
    const sample = grid.sample.bind(grid);
    const convolve = (values) => {
        for (let i = 0; i < 27; i++) values[i] *= kConvolution[i];
        return values;
    };
    grid.coeffs = (i, out) => convolve(coeffs(i, out));
    grid.sample = (position) => convolve(sample(position));
    return grid;
}

/**
 * @param map from readMap
 * @returns {{uniform: UniformGridSH|null, sparse: SparseGridSH|null, legacy: LegacyGrid|StyledGrid|null,
 *   problems: string[]}}
 */
export function readGrids(map) {
    const problems = [];
    const world = map.entities[0];
    const radiance = world?.get('_q3map2_sh') === 'radiance';
    const attempt = (lump, read) => {
        if (!lump || lump.length === 0) return null;
        try {
            return read(lump);
        } catch (error) {
            if (!(error instanceof FormatError)) throw error;
            problems.push(error.message);
            return null;
        }
    };
    const styled = (array) => {
        const grid = new StyledGrid(map.lumps[Lump.lightGrid], array, map.models[0], world);
        if (grid.outside > 0)
            problems.push(`${grid.outside} of ${grid.count} points of the legacy light grid name no light.`);
        return grid;
    };
    const isIbsp = map.ident === 'IBSP';
    const sh = (Reader) => (lump) => (radiance ? convolved(new Reader(lump)) : new Reader(lump));
    return {
        uniform: attempt(map.lumps[Lump.lightGridSH] ?? map.bspx.get('LIGHTGRID_SH'), sh(UniformGridSH)),
        sparse: attempt(map.bspx.get('LIGHTGRID_SH_SPARSE'), sh(SparseGridSH)),
        legacy: isIbsp
            ? attempt(map.lumps[Lump.lightGrid], (lump) => new LegacyGrid(lump, map.models[0], world))
            : attempt(map.lumps[Lump.lightArray], styled),
        problems,
    };
}
