// GPL-2.0-or-later. Points at equal distances, x fastest, then y, then z.

/** Base of the grids that have `mins`, `cell` and `bounds` (points) for each axis. */
export class Lattice {
    /** @type {number[]} */ mins;
    /** @type {number[]} */ cell;
    /** @type {number[]} */ bounds;

    position(i) {
        const [nx, ny] = this.bounds;
        const index = [i % nx, Math.floor(i / nx) % ny, Math.floor(i / (nx * ny))];
        return index.map((n, axis) => this.mins[axis] + n * this.cell[axis]);
    }

    /** Shortest edge of the cell of a point. */
    size() {
        return Math.min(...this.cell);
    }

    /** Level of a point in a sparse grid; here all are alike. */
    level() {
        return 0;
    }

    /** Calls visit(i, x, y, z) for the points in a box. */
    forEachIn(mins, maxs, visit) {
        const { mins: from, cell, bounds } = this;
        const low = cell.map((size, axis) => Math.max(0, Math.ceil((mins[axis] - from[axis]) / size)));
        const high = cell.map((size, axis) => Math.min(bounds[axis] - 1, Math.floor((maxs[axis] - from[axis]) / size)));
        for (let z = low[2]; z <= high[2]; z++)
            for (let y = low[1]; y <= high[1]; y++)
                for (let x = low[0]; x <= high[0]; x++)
                    visit(
                        x + bounds[0] * (y + bounds[1] * z),
                        from[0] + x * cell[0],
                        from[1] + y * cell[1],
                        from[2] + z * cell[2],
                    );
    }
}
