// GPL-2.0-or-later. Chromium without a screen, with software WebGL and a fresh profile, on the built page.
import { chromium } from 'playwright-core';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const kFlags = [
    '--no-sandbox',
    '--disable-gpu',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--use-gl=angle',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
];

export const kPage = join(import.meta.dirname, '..', 'viewer.html');

/**
 * Opens a page, hands it to `use`, and closes everything.
 * @param {object} options of the context, such as viewport and hasTouch
 * @param {(page: import('playwright-core').Page, faults: string[]) => Promise<void>} use
 *   faults: console errors, exceptions and requests to a network so far
 * @param {string} path of the page
 */
export async function withPage(options, use, path = kPage) {
    const profile = mkdtempSync(join(tmpdir(), 'viewer-'));
    const context = await chromium.launchPersistentContext(profile, {
        executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
        headless: true,
        args: kFlags,
        ...options,
    });
    try {
        const page = context.pages()[0] ?? (await context.newPage());
        const faults = [];
        page.on('console', (message) => message.type() === 'error' && faults.push(message.text()));
        page.on('pageerror', (error) => faults.push(String(error)));
        page.on(
            'request',
            (request) => /^(https?|wss?):/.test(request.url()) && faults.push(`request: ${request.url()}`),
        );
        await page.goto(pathToFileURL(path).href);
        await use(page, faults);
    } finally {
        await context.close();
        rmSync(profile, { recursive: true, force: true });
    }
}

/** Hands files to the page's chooser and waits until a map or a message shows. */
export async function openFiles(page, paths) {
    await page.setInputFiles('#chooser', paths);
    await page.waitForFunction(() => !document.getElementById('status').hidden || document.querySelector('.message'));
}

/** Waits until all textures have been loaded. */
export async function texturesLoaded(page) {
    await page.waitForFunction(() => window.viewer.viewer.stats.texturesDone > 0);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}
