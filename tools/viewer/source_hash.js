// GPL-2.0-or-later. SHA-256 of what viewer.html is made of: a page with another one is out of date.
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const kFiles = ['index.html', 'package-lock.json', 'package.json', 'source_hash.js', 'vite.config.js'];

/** Paths of all sources below the folder, sorted by their bytes. */
function sources(folder) {
    const below = readdirSync(join(folder, 'src'), { recursive: true, withFileTypes: true })
        .filter((entry) => entry.isFile())
        .map((entry) =>
            join(entry.parentPath, entry.name)
                .slice(folder.length + 1)
                .replaceAll('\\', '/'),
        );
    return [...kFiles, ...below].sort();
}

/** Hash of "path NUL length NUL bytes" of each source. */
export function sourceHash(folder) {
    const hash = createHash('sha256');
    for (const path of sources(folder)) {
        const bytes = readFileSync(join(folder, path));
        hash.update(`${path}\0${bytes.length}\0`).update(bytes);
    }
    return hash.digest('hex');
}
