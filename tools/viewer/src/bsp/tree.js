// GPL-2.0-or-later. Leafs and clusters of a map: what contains a position, what sees what.
import { viewOf } from './bytes.js';

/** Searches in the BSP tree of a map. Damaged trees give wrong leafs, never an endless search. */
export class BspTree {
    /** @param tree the `tree` of readMap */
    constructor(tree) {
        this.tree = tree;
        const visibility = tree.visibility;
        this.clusterCount = 0;
        this.rowBytes = 0;
        if (visibility.length < 8) return;
        const view = viewOf(visibility);
        const [clusters, bytes] = [view.getInt32(0, true), view.getInt32(4, true)];
        if (clusters < 0 || bytes < clusters / 8 || 8 + clusters * bytes > visibility.length) return;
        this.clusterCount = clusters;
        this.rowBytes = bytes;
    }

    /** Number of the leaf that contains a position. */
    leafAt(x, y, z) {
        const { planes, planeCount, nodes, nodeCount, leafCount } = this.tree;
        let node = 0;
        for (let steps = 0; node >= 0 && steps < 4096 && node < nodeCount; steps++) {
            const plane = nodes[9 * node];
            if (plane < 0 || plane >= planeCount) return 0;
            const side =
                planes[4 * plane] * x + planes[4 * plane + 1] * y + planes[4 * plane + 2] * z - planes[4 * plane + 3];
            node = nodes[9 * node + (side > 0 ? 1 : 2)];
        }
        const leaf = -1 - node;
        return leaf >= 0 && leaf < leafCount ? leaf : 0;
    }

    /** Cluster of a leaf; below 0: solid. */
    clusterOf(leaf) {
        return this.tree.leafs[12 * leaf];
    }

    clusterAt(x, y, z) {
        return this.clusterOf(this.leafAt(x, y, z));
    }

    /** Whether a cluster sees another. Without visibility data, or from solid space, all are seen. */
    sees(from, to) {
        if (this.clusterCount === 0 || from < 0 || from >= this.clusterCount) return true;
        if (to < 0 || to >= this.clusterCount) return false;
        return ((this.tree.visibility[8 + from * this.rowBytes + (to >> 3)] >> (to & 7)) & 1) === 1;
    }

    /**
     * For each surface the clusters of the leafs that it is in.
     * @returns {number[][]} empty for surfaces of models other than the world
     */
    surfaceClusters(surfaceCount) {
        const { leafs, leafCount, leafSurfaces } = this.tree;
        const sets = Array.from({ length: surfaceCount }, () => /** @type {number[]} */ ([]));
        for (let leaf = 0; leaf < leafCount; leaf++) {
            const cluster = leafs[12 * leaf];
            const [first, count] = [leafs[12 * leaf + 8], leafs[12 * leaf + 9]];
            if (cluster < 0 || first < 0 || count < 0 || first + count > leafSurfaces.length) continue;
            for (let i = first; i < first + count; i++)
                if (!(sets[leafSurfaces[i]]?.includes(cluster) ?? true)) sets[leafSurfaces[i]].push(cluster);
        }
        return sets;
    }
}
