// GPL-2.0-or-later. Builds the page into one file that works from a disk.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { defineConfig } from 'vite';
import { sourceHash } from './source_hash.js';

const kLibraries = ['three', 'fflate'];
const kMarker = '<!-- package -->';

/** Licences of the libraries inside the page, as a comment. */
function licences() {
    const texts = kLibraries.map(
        (name) =>
            `${name}:\n${readFileSync(join(import.meta.dirname, 'node_modules', name, 'LICENSE'), 'utf8').trim()}`,
    );
    return `<!--\nThis page is GPL-2.0-or-later. It contains two libraries:\n\n${texts.join('\n\n')}\n-->`;
}

/** Puts scripts and styles into the page, and the hash of the sources. */
function oneFile() {
    return {
        name: 'one-file',
        enforce: 'post',
        generateBundle(_, bundle) {
            const page = bundle['index.html'];
            const scripts = Object.values(bundle).filter((part) => part.type === 'chunk');
            const styles = Object.values(bundle).filter((part) => part.fileName.endsWith('.css'));
            let html = String(page.source)
                .replace(/\s*<script[^>]*src=[^>]*><\/script>/g, '')
                .replace(/\s*<link rel="stylesheet"[^>]*>/g, '');
            const code = scripts
                .map((part) => part.code)
                .join('\n')
                .replaceAll('</script', '<\\/script');
            const script = `<script type="module">${code}</script>`;
            const hash = createHash('sha256').update(code).digest('base64');
            html = html
                .replace("script-src 'unsafe-inline' 'self'", () => `script-src 'sha256-${hash}'`)
                .replace("style-src 'unsafe-inline' 'self'", "style-src 'unsafe-inline'")
                .replace('<html lang="en">', () => `<html lang="en">\n${licences()}`)
                .replace(
                    '<meta charset="utf-8">',
                    () =>
                        `<meta charset="utf-8">\n<meta name="source-sha256" content="${sourceHash(import.meta.dirname)}">`,
                )
                .replace('</head>', () => `<style>${styles.map((part) => part.source).join('\n')}</style>\n</head>`)
                .replace('</body>', () => `${script}\n</body>`);
            if (html.split(kMarker).length !== 2) this.error(`the page must contain ${kMarker} once`);
            page.source = html;
            for (const part of [...scripts, ...styles]) delete bundle[part.fileName];
        },
    };
}

export default defineConfig({
    base: './',
    plugins: [oneFile()],
    build: {
        target: 'es2022',
        modulePreload: false,
        assetsInlineLimit: 0,
        cssCodeSplit: false,
        reportCompressedSize: false,
    },
});
