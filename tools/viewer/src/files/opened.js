// GPL-2.0-or-later. What files a visitor hands over: maps, archives and files beside maps, with their names as paths.

/** Kinds of files that belong to a map, by extension. */
export const kSideExtensions = {
    '.lin': 'leak',
    '.prt': 'portals',
    '.sherror.json': 'errors',
    '.unexplained.json': 'unexplained',
    '.explain.json': 'explanations',
};

const kTextures = /^(textures|models|env|gfx|maps)\/.*\.(tga|jpe?g|png|webp)$/i;

/** Extension of a path, lower case, with its dot; '' if there is none. */
export function extensionOf(path) {
    return path.toLowerCase().match(/(\.(sherror|unexplained|explain)\.json|\.[^./]+)$/)?.[1] ?? '';
}

/** Whether the page has a use for a file. */
export function isKnown(path) {
    const extension = extensionOf(path);
    return (
        extension in kSideExtensions ||
        ['.bsp', '.pk3', '.zip', '.shader'].includes(extension) ||
        kTextures.test(path)
    );
}

/** Name of a file without its folder and extension. */
export function baseName(path) {
    const name = path.slice(path.lastIndexOf('/') + 1);
    return name.slice(0, name.length - extensionOf(name).length);
}

/** All files that were dropped; of folders those that the page has a use for. */
export async function droppedFiles(transfer) {
    const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
    if (entries.length === 0) return [...transfer.files].map((file) => ({ path: file.name, blob: file }));
    const found = await Promise.all(entries.map((entry) => filesBelow(entry)));
    return found.flat().filter(({ path, inFolder }) => !inFolder || isKnown(path));
}

async function filesBelow(entry) {
    if (entry.isFile) {
        const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
        const inFolder = entry.fullPath.lastIndexOf('/') > 0;
        return [{ path: gamePath(entry.fullPath), blob: file, inFolder }];
    }
    const reader = entry.createReader();
    const files = [];
    for (;;) {
        const part = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (part.length === 0) return files;
        for (const child of part) files.push(...(await filesBelow(child)));
    }
}

/** A path as games know it: what follows the folder of the game, where a known folder tells it. */
export function gamePath(path) {
    const known = path.replace(/^\/+/, '').match(/(?:^|\/)((?:maps|textures|scripts|shaders|models|env|gfx|sound)\/.*)$/i);
    return known ? known[1] : path.replace(/^\/+/, '');
}

/**
 * The package inside a report page.
 * @returns {{path: string, blob: Blob, map: string}|null} null if the page has none
 */
export function embeddedPackage(page) {
    const element = page.getElementById('package');
    if (!element) return null;
    const bytes = Uint8Array.from(atob(element.textContent.replace(/\s+/g, '')), (c) => c.charCodeAt(0));
    return { path: 'report.pk3', blob: new Blob([bytes]), map: (element.dataset.map ?? '').toLowerCase() };
}
