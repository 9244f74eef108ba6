// GPL-2.0-or-later. Takes pictures of two versions of maps at the same places, in pages of -shreport.
//
// usage: node pictures.js JOBS.json
// JOBS: [{ before, now: pages; places: [[x, y, z, yaw]]; out: folder }]. Writes N.before.jpg, N.now.jpg and
// differences.json, the largest and the mean difference of each pair in levels of 255. A map whose page fails has none.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { texturesLoaded, withPage } from '../viewer/tests/browser.js';

const kSize = { width: 480, height: 360 };

/** Runs in the page. @returns {Promise<string[]>} the view as pixels RGBA and as JPEG, both in base 64 */
async function view([x, y, z, yaw]) {
    const { viewer } = window.viewer;
    viewer.camera.position.set(x, y, z);
    [viewer.walk.yaw, viewer.walk.pitch] = [(yaw * Math.PI) / 180, 0];
    viewer.drawNow();
    const canvas = document.getElementById('view');
    const copy = new OffscreenCanvas(canvas.width, canvas.height);
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
    const picture = await copy.convertToBlob({ type: 'image/jpeg', quality: 0.75 });
    return [pixels, new Uint8Array(await picture.arrayBuffer())].map((bytes) => {
        let text = '';
        for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
        return btoa(text);
    });
}

/** Pixels of the map in a page at each place, RGBA. Writes a picture of each. */
async function take(page, path, places, out, name) {
    await page.goto(pathToFileURL(path).href);
    await page.waitForFunction(() => !document.getElementById('status').hidden);
    await texturesLoaded(page);
    await page.evaluate(() => {
        Object.assign(window.viewer.viewer.settings, { leak: false, portals: false });
        window.viewer.viewer.changed();
    });
    const pixels = [];
    for (const [number, place] of places.entries()) {
        const [raw, picture] = (await page.evaluate(view, place)).map((text) => Buffer.from(text, 'base64'));
        pixels.push(raw);
        writeFileSync(join(out, `${number}.${name}.jpg`), picture);
    }
    return pixels;
}

/** Of two pictures of RGBA. */
function difference(before, now) {
    let [largest, sum] = [0, 0];
    for (let at = 0; at < before.length; at++) {
        const levels = Math.abs(before[at] - now[at]);
        largest = Math.max(largest, levels);
        sum += levels;
    }
    return { largest, mean: sum / ((before.length / 4) * 3) };
}

const jobs = JSON.parse(readFileSync(process.argv[2], 'utf8'));
await withPage({ viewport: kSize }, async (page) => {
    for (const { before, now, places, out } of jobs) {
        try {
            const old = await take(page, before, places, out, 'before');
            const fresh = await take(page, now, places, out, 'now');
            const differences = old.map((pixels, i) => difference(pixels, fresh[i]));
            writeFileSync(join(out, 'differences.json'), JSON.stringify(differences));
        } catch (error) {
            console.error(`${out}: ${error}`); // the other maps still get theirs
        }
    }
});
