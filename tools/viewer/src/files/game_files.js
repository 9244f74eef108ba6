// GPL-2.0-or-later. Loose files and archives as one tree, as games search them.
import { Archive } from './zip.js';

export class GameFiles {
    /** @type {Archive[]} in order of their names: later ones come first, as in the game */
    archives = [];
    /** @type {Map<string, Blob>} loose files by lower-case path; they come before archives */
    loose = new Map();
    /** Changes whenever images may have. */
    revision = 0;

    /** Adds an archive, or a loose file under its path. */
    async add(path, blob) {
        const lower = path.toLowerCase();
        if (!lower.endsWith('.bsp')) this.revision++;
        if (!/\.(pk3|zip)$/.test(lower)) {
            this.loose.set(lower, blob);
            return;
        }
        const archive = await Archive.open(blob, path);
        this.archives = this.archives.filter((other) => other.name !== path);
        this.archives.push(archive);
        this.archives.sort((a, b) => (a.name.toLowerCase() < b.name.toLowerCase() ? -1 : 1));
    }

    /** All paths for which the test holds, each once. */
    list(test) {
        const paths = new Set([
            ...this.loose.keys(),
            ...this.archives.flatMap((archive) => [...archive.entries.keys()]),
        ]);
        return [...paths].filter((path) => test(path)).sort();
    }

    has(path) {
        return this.loose.has(path) || this.archives.some((archive) => archive.entries.has(path));
    }

    /**
     * @param {string} path lower case
     * @returns {Promise<Uint8Array|null>} null if there is none
     */
    async read(path) {
        const loose = this.loose.get(path);
        if (loose) return new Uint8Array(await loose.arrayBuffer());
        for (let i = this.archives.length - 1; i >= 0; i--)
            if (this.archives[i].entries.has(path)) return this.archives[i].read(path);
        return null;
    }
}
