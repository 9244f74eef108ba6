// GPL-2.0-or-later. From files that a visitor hands over to the map on the screen.
import { FormatError } from './bsp/bytes.js';
import { readMap } from './bsp/map.js';
import { parseErrors, parseExplanations, parseLeakLine, parsePortals, parseUnexplained } from './bsp/side_files.js';
import { GameFiles } from './files/game_files.js';
import { baseName, extensionOf, isKnown, kSideExtensions } from './files/opened.js';
import { splitScript } from './files/shader_script.js';

const kReaders = {
    leak: parseLeakLine,
    portals: parsePortals,
    errors: parseErrors,
    unexplained: parseUnexplained,
    explanations: parseExplanations,
};

/** How messages begin about files that name a map. */
const kOfMap = {
    errors: 'The errors are',
    unexplained: 'The unexplained light is',
    explanations: 'The explanations are',
};

export class Opener {
    files = new GameFiles();
    /** Path of the shown map. */
    path = '';
    /** Texts of files beside it that were handed over alone, by kind. */
    sides = new Map();

    /**
     * @param {import('./viewer.js').Viewer} viewer
     * @param {import('./ui/messages.js').Messages} messages
     * @param {(paths: string[], shown: string) => void} opened called when a map is on the screen
     */
    constructor(viewer, messages, opened) {
        this.viewer = viewer;
        this.messages = messages;
        this.opened = opened;
    }

    /** Shows a message for what the visitor can act on; anything else is a fault of the page. `path`: of the file. */
    report(error, path = '') {
        const expected = error instanceof FormatError;
        if (!expected) console.error(error);
        const text = expected ? error.message : `The page failed: ${error.message}`;
        this.messages.add('error', path ? `${path}: ${text}` : text);
    }

    /**
     * Opens maps, archives and files beside maps, of one or several drops.
     * @param {{path: string, blob: Blob}[]} given
     * @param {string} [wanted] path of the map to show
     */
    async add(given, wanted = '') {
        const started = performance.now();
        this.messages.clear();
        const sides = [];
        let resources = false;
        let map = wanted;
        for (const { path, blob, inFolder } of given) {
            const extension = extensionOf(path);
            if (extension in kSideExtensions) {
                sides.push({ kind: kSideExtensions[extension], blob, path, inFolder });
            } else if (!isKnown(path)) {
                this.messages.add(
                    'error',
                    `${path} is not a file that this page opens: it takes .bsp, .pk3, .lin, .prt, .sherror.json, .unexplained.json and .explain.json.`,
                );
            } else {
                resources = (await this.addFile(path, blob)) || resources;
                if (extension === '.bsp') map ||= path.toLowerCase();
            }
        }
        await this.showAfter(map, resources, sides, started);
    }

    async addFile(path, blob) {
        try {
            await this.files.add(path, blob);
            return true;
        } catch (error) {
            this.report(error);
            return false;
        }
    }

    async showAfter(map, resources, sides, started) {
        const choice = map || this.path || this.maps()[0];
        try {
            if (resources && choice) await this.show(choice, started);
            else if (resources) this.messages.add('note', 'The archive has no map: open the .bsp too.');
        } catch (error) {
            this.files.loose.delete(choice);
            this.report(error, choice);
        }
        if (sides.length > 0 && !this.viewer.map)
            this.messages.add('error', 'Open the map before the files that belong to it.');
        else
            for (const { kind, blob, path, inFolder } of sides)
                if (!inFolder || this.isBeside(path)) this.keepSide(kind, await blob.text());
    }

    /** Whether a file has the name of the shown map. */
    isBeside(path) {
        return baseName(path.toLowerCase()) === baseName(this.path);
    }

    maps() {
        return this.files.list((path) => path.endsWith('.bsp'));
    }

    /** Shaders of all scripts by name; the first of two with one name. */
    async scripts() {
        const decoder = new TextDecoder('latin1');
        const paths = this.files.list((path) => /^((scripts|shaders)\/)?[^/]+\.shader$/.test(path));
        const scripts = await Promise.all(
            paths.map(async (path) => splitScript(decoder.decode(await this.files.read(path)))),
        );
        return new Map(scripts.reverse().flatMap((shaders) => [...shaders]));
    }

    /**
     * Shows a newer version of a map, from where the viewer is.
     * @param {string} path lower case
     * @param {Blob} bsp
     * @param {{path: string, blob: Blob}|null} archive with its shaders and textures; null: those before stay
     */
    async update(path, bsp, archive) {
        this.messages.clear();
        if (archive) await this.files.add(archive.path, archive.blob);
        await this.files.add(path, bsp);
        await this.show(path);
    }

    /** Shows a map of those that are open, with the files beside it. */
    async show(path, started = performance.now()) {
        const [bytes, scripts] = await Promise.all([this.files.read(path), this.scripts()]);
        const map = readMap(bytes ?? new Uint8Array());
        if (path !== this.path) this.sides.clear();
        this.path = path;
        await this.viewer.open(map, path, this.files, scripts, started);
        for (const problem of [...map.problems, ...this.viewer.grids.problems, this.viewer.toneProblem].filter(Boolean))
            this.messages.add('error', `${problem} The map is shown without it.`);
        await this.addNeighbors(path);
        this.opened(this.maps(), path);
        await this.viewer.loadTextures(this.files, started);
        this.opened(this.maps(), path);
    }

    /** Files with the map's name beside it, and those that were handed over before. */
    async addNeighbors(path) {
        const base = path.replace(/\.bsp$/, '');
        for (const [extension, kind] of Object.entries(kSideExtensions)) {
            const bytes = await this.files.read(base + extension);
            if (bytes) this.addSide(kind, new TextDecoder().decode(bytes));
        }
        for (const [kind, text] of this.sides) this.addSide(kind, text);
    }

    keepSide(kind, text) {
        this.sides.set(kind, text);
        this.addSide(kind, text);
        this.opened(this.maps(), this.path);
    }

    addSide(kind, text) {
        try {
            const value = kReaders[kind](text);
            if (kind === 'leak') this.viewer.setLeak(value);
            else if (kind === 'portals') this.viewer.setPortals(value);
            else this.setOfMap(kind, value);
        } catch (error) {
            this.report(error);
        }
    }

    /** Errors, unexplained light or explanations, which name the map that they are of. */
    setOfMap(kind, value) {
        if (value.map && !this.isBeside(value.map))
            this.messages.add('note', `${kOfMap[kind]} of ${value.map}, not of the map that is shown.`);
        if (kind === 'errors') this.viewer.setErrors(value);
        else if (kind === 'unexplained') this.viewer.setUnexplained(value);
        else this.viewer.setExplanations(value);
    }
}
