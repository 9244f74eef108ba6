// GPL-2.0-or-later. The sparse SH light grid: BSPX lump LIGHTGRID_SH_SPARSE.
import { expect, float32s, textAt, viewOf } from './bytes.js';

const kHeaderBytes = 64;
const kNodeBytes = 12;
const kPointBytes = 28;
const kMostLevels = 12;
const kMostCells = 2 ** 24; // smallest cells on an axis
const kLimits = [2 / Math.sqrt(3), Math.sqrt(5) / 4]; // of bands 1 and 2, over coefficient 0

function bits(mask) {
    let count = 0;
    for (; mask; mask &= mask - 1) count++;
    return count;
}

export class SparseGridSH {
    /**
     * @param {Uint8Array} lump
     * @throws FormatError if it contradicts itself
     */
    constructor(lump) {
        expect(
            lump.length >= kHeaderBytes && textAt(lump, 0, 4) === 'SHGS',
            'The sparse SH light grid has no valid header.',
        );
        const view = viewOf(lump);
        const word = (offset) => view.getUint32(offset, true);
        expect(word(4) === 1, `The sparse SH light grid is of version ${word(4)}; this page reads 1.`);
        const head = float32s(lump.subarray(12, 36));
        this.mins = [...head.subarray(0, 3)];
        this.cell = [...head.subarray(3, 6)];
        this.roots = [view.getInt32(36, true), view.getInt32(40, true), view.getInt32(44, true)];
        this.levels = word(48);
        this.nodeCount = word(52);
        this.count = word(56);
        const bytes = kHeaderBytes + kNodeBytes * this.nodeCount + kPointBytes * this.count;
        expect(
            word(8) === lump.length && bytes === lump.length && word(60) === 0,
            'The sparse SH light grid is cut off, or its counts do not fit its lump.',
        );
        this.checkHead();
        this.nodes = lump.subarray(kHeaderBytes, kHeaderBytes + kNodeBytes * this.nodeCount);
        this.points = lump.subarray(kHeaderBytes + kNodeBytes * this.nodeCount);
        this.nodeView = viewOf(this.nodes);
        this.pointView = viewOf(this.points);
        this.checkNodes();
        this.placePoints();
    }

    checkHead() {
        expect(this.levels >= 1 && this.levels <= kMostLevels, `The sparse SH light grid has ${this.levels} levels.`);
        this.bounds = this.roots.map((n) => n * 2 ** this.levels); // smallest cells
        const sane = this.bounds.every(
            (n, i) =>
                this.roots[i] >= 1 &&
                n <= kMostCells &&
                Number.isFinite(this.mins[i]) &&
                Number.isFinite(this.cell[i]) &&
                this.cell[i] > 0 &&
                Number.isFinite(Math.fround(this.mins[i] + this.cell[i] * n)),
        );
        expect(sane, 'The sparse SH light grid has roots or cells out of range.');
        expect(
            this.roots[0] * this.roots[1] * this.roots[2] <= this.nodeCount,
            'The sparse SH light grid has fewer nodes than roots.',
        );
    }

    node(i) {
        const at = kNodeBytes * i;
        return {
            children: this.nodeView.getUint32(at, true),
            points: this.nodeView.getUint32(at + 4, true),
            inner: this.nodes[at + 8],
            stored: this.nodes[at + 9],
            hanging: this.nodes[at + 10],
            scale: this.nodes[at + 11],
        };
    }

    /** One pass, level by level: children and points of each node follow those of the node before. */
    checkNodes() {
        const bad = (i) => `Node ${i} of the sparse SH light grid contradicts the tree.`;
        let children = this.roots[0] * this.roots[1] * this.roots[2];
        let points = 0;
        let level = 0;
        let levelEnd = children;
        for (let i = 0; i < this.nodeCount; i++) {
            const node = this.node(i);
            if (i === levelEnd) {
                level++;
                levelEnd = children;
            }
            expect(i < children && node.children === children && node.points === points, bad(i));
            expect(!(node.inner & node.stored || node.inner & node.hanging || node.stored & node.hanging), bad(i));
            expect(!(level === this.levels - 1 && node.inner) && !(level === 0 && node.hanging), bad(i));
            children += bits(node.inner);
            points += bits(node.stored);
        }
        expect(
            children === this.nodeCount && points === this.count,
            'The tree of the sparse SH light grid has other counts than its header.',
        );
    }

    /** For each stored point its position, its level (0: smallest cells) and the scale of its node. */
    placePoints() {
        this.positions = new Float32Array(3 * this.count);
        this.pointLevels = new Uint8Array(this.count);
        this.scales = new Uint8Array(this.count);
        const corner = new Int32Array(3 * this.nodeCount); // of nodes, in smallest cells
        const size = new Uint8Array(this.nodeCount); // log2 of the edge of the node's cells
        const [rx, ry, rz] = this.roots;
        for (let i = 0; i < rx * ry * rz; i++) {
            const root = [i % rx, Math.floor(i / rx) % ry, Math.floor(i / (rx * ry))];
            corner.set(
                root.map((n) => n * 2 ** this.levels),
                3 * i,
            );
            size[i] = this.levels - 1;
        }
        for (let i = 0; i < this.nodeCount; i++)
            this.placeNode(this.node(i), corner.subarray(3 * i, 3 * i + 3), size[i], corner, size);
    }

    placeNode(node, low, size, corner, sizes) {
        let { children, points } = node;
        for (let c = 0; c < 8; c++) {
            const at = [0, 1, 2].map((axis) => low[axis] + (((c >> axis) & 1) << size));
            if ((node.inner >> c) & 1) {
                corner.set(at, 3 * children);
                sizes[children++] = size - 1;
            } else if ((node.stored >> c) & 1) {
                this.positions.set(
                    at.map((n, axis) => this.mins[axis] + n * this.cell[axis]),
                    3 * points,
                );
                this.pointLevels[points] = size;
                this.scales[points++] = node.scale;
            }
        }
    }

    /** Adds weight times point i, quantized with the scale of a node, to 27 sums. */
    addPoint(i, scale, weight, sum) {
        const at = kPointBytes * i;
        const code = this.pointView.getUint32(at, true);
        const unit = weight * 2 ** ((code >>> 27) - 24);
        const mean = [unit * (code & 511), unit * ((code >>> 9) & 511), unit * ((code >>> 18) & 511)];
        const factor = 2 ** ((scale - 128) / 8) / 127;
        for (let channel = 0; channel < 3; channel++) sum[channel] += mean[channel];
        for (let k = 1; k < 9; k++) {
            const limit = factor * kLimits[k < 4 ? 0 : 1];
            for (let channel = 0; channel < 3; channel++) {
                const q = Math.max(this.pointView.getInt8(at + 1 + 3 * k + channel), -127);
                sum[3 * k + channel] += q * limit * mean[channel];
            }
        }
    }

    coeffs(i, out = new Float32Array(27)) {
        out.fill(0);
        this.addPoint(i, this.scales[i], 1, out);
        return out;
    }

    position(i) {
        return [...this.positions.subarray(3 * i, 3 * i + 3)];
    }

    size(i) {
        return Math.min(...this.cell) * 2 ** this.pointLevels[i];
    }

    level(i) {
        return this.pointLevels[i];
    }

    forEachIn(mins, maxs, visit) {
        const p = this.positions;
        for (let i = 0, at = 0; i < this.count; i++, at += 3) {
            if (p[at] < mins[0] || p[at] > maxs[0] || p[at + 1] < mins[1] || p[at + 1] > maxs[1]) continue;
            if (p[at + 2] >= mins[2] && p[at + 2] <= maxs[2]) visit(i, p[at], p[at + 1], p[at + 2]);
        }
    }

    /** The cell that contains a position in smallest cells, inside the roots: its node, octant and log2 of its edge. */
    descend(at) {
        const root = at.map((n) => Math.floor(n / 2 ** this.levels));
        let node = this.node(root[0] + this.roots[0] * (root[1] + this.roots[1] * root[2]));
        for (let size = this.levels - 1; ; size--) {
            const octant = ((at[0] >> size) & 1) | (((at[1] >> size) & 1) << 1) | (((at[2] >> size) & 1) << 2);
            if (!((node.inner >> octant) & 1)) return { node, octant, size };
            node = this.node(node.children + bits(node.inner & ((1 << octant) - 1)));
        }
    }

    /** Adds the value at a corner to the sums; false if larger cells give it one. */
    addCorner(at, weight, sums) {
        if (at.some((n, axis) => n < 0 || n >= this.bounds[axis])) return true;
        const { node, octant, size } = this.descend(at);
        if ((at[0] | at[1] | at[2]) & ((1 << size) - 1)) return false;
        if ((node.stored >> octant) & 1) {
            this.addPoint(node.points + bits(node.stored & ((1 << octant) - 1)), node.scale, weight, sums.values);
            sums.weight += weight;
            return true;
        }
        return !((node.hanging >> octant) & 1);
    }

    /** Blend in the cell around a position in smallest cells; null if no corner with a weight has a value. */
    blend(at, alike) {
        const cell = this.descend(at.map((n, axis) => Math.min(Math.floor(n), this.bounds[axis] - 1)));
        let size = cell.size;
        const low = at.map((n, axis) => (Math.min(Math.floor(n), this.bounds[axis] - 1) >> size) << size);
        const fraction = at.map((n, axis) => (n - low[axis]) / 2 ** size);
        const weights = Array.from({ length: 8 }, (_, i) =>
            [0, 1, 2].reduce(
                (product, axis) => product * (alike ? 0.5 : (i >> axis) & 1 ? fraction[axis] : 1 - fraction[axis]),
                1,
            ),
        );
        const sums = { values: new Float32Array(27), weight: 0 };
        for (let pending = true; pending && size < this.levels; size++) {
            pending = false;
            for (let i = 0; i < 8; i++) {
                if (!(weights[i] > 0)) continue;
                const corner = low.map((n, axis) => n + (((i >> axis) & 1) << size));
                if (this.addCorner(corner, weights[i], sums)) weights[i] = 0;
                else pending = true;
            }
            if (pending) widen(low, size, weights);
        }
        return sums.weight > 1e-20 ? sums.values.map((value) => value / sums.weight) : null;
    }

    /** The light at a position, clamped to the roots; black where no corner has a value. */
    sample(position) {
        const at = position.map((p, axis) => {
            const n = (p - this.mins[axis]) / this.cell[axis];
            return n > 0 ? Math.min(n, this.bounds[axis]) : 0;
        });
        return this.blend(at, false) ?? this.blend(at, true) ?? new Float32Array(27);
    }
}

/** Moves weights of corners of a cube of 2^size cells to those of the cube twice as large around it. */
function widen(low, size, weights) {
    for (let axis = 0; axis < 3; axis++) {
        const upper = (low[axis] >> size) & 1;
        low[axis] -= upper << size;
        for (let i = 0; i < 8; i++) {
            if ((i >> axis) & 1) continue;
            const [middle, end] = upper ? [i, i | (1 << axis)] : [i | (1 << axis), i];
            const half = weights[middle] / 2;
            weights[middle] = half;
            weights[end] += half;
        }
    }
}
