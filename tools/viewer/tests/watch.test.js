// GPL-2.0-or-later. The page of q3map2 -watch in Chromium: what saves of a small map show. PROGRAM names q3map2.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { withPage } from './browser.js';
import { roomSource } from './watched_room.js';
import { startWatch } from './watching.js';

let folder;
before(() => {
    folder = mkdtempSync(join(tmpdir(), 'watch-test-'));
});
after(() => rmSync(folder, { recursive: true }));

/** A game folder with the source of a map in it. */
function makeGame(name, source) {
    const base = join(folder, name);
    for (const below of ['maps', 'scripts']) mkdirSync(join(base, 'baseq3', below), { recursive: true });
    writeFileSync(
        join(base, 'baseq3/scripts/t.shader'),
        'textures/t/wall\n{\n\t{\n\t\tmap $whiteimage\n\t\trgbGen exactVertex\n\t}\n\t{\n\t\tmap $lightmap\n\t}\n}\n',
    );
    const map = join(base, 'baseq3/maps/room.map');
    writeFileSync(map, source);
    return { base, map };
}

/** Waits until the light of that save is on the screen. */
async function shown(page, save, pass) {
    await page.waitForFunction(
        ([wantedSave, wantedPass]) => {
            const { state, shown: version } = window.viewer?.watch ?? {};
            return state?.save === wantedSave && version === state.version && state.pass === wantedPass && !state.running;
        },
        [save, pass],
        { timeout: 120000 },
    );
}

const camera = (page) =>
    page.evaluate(() => {
        const { viewer } = window.viewer;
        return [...viewer.camera.position.toArray(), viewer.walk.yaw, viewer.walk.pitch, viewer.settings.brightness];
    });

/** Mean brightness of the left and the right half of the picture. */
const halves = (page) =>
    page.evaluate(() => {
        const { viewer } = window.viewer;
        viewer.drawNow();
        const gl = viewer.renderer.getContext();
        const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
        const pixels = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        const sums = [0, 0];
        for (let i = 0; i < width * height; i++) sums[2 * (i % width) < width ? 0 : 1] += pixels[4 * i + 1];
        return sums.map((sum) => (2 * sum) / (width * height));
    });

async function follow(name, source, use) {
    const { base, map } = makeGame(name, source);
    const watch = await startWatch(process.env.PROGRAM, ['-fs_basepath', base, '-fs_nohomepath'], map);
    try {
        await withPage({ viewport: { width: 1024, height: 640 } }, async (page, faults) => {
            await page.goto(watch.address);
            await use(page, map);
            const { host } = new URL(watch.address);
            const own = new RegExp(`^request: (http|ws)://${host}/`);
            assert.deepEqual(
                faults.filter((fault) => !own.test(fault)),
                [],
            );
        });
    } finally {
        assert.equal(await watch.end(), 0);
    }
}

test('a lamp is moved: the light changes, and the camera stays', () =>
    follow('lamp', roomSource({ lamp: [0, 128, 64] }), async (page, map) => {
        await shown(page, 1, 'final');
        assert.equal(await page.isVisible('#start'), false);
        await page.evaluate(() => {
            const { viewer } = window.viewer;
            viewer.camera.position.set(-150, 0, 64); // looks along x; y grows to the left
            Object.assign(viewer.walk, { yaw: 0, pitch: 0 });
            viewer.settings.lights = false;
            viewer.settings.brightness = 1.5;
            viewer.changed();
        });
        const before = [await camera(page), await halves(page)];
        writeFileSync(map, roomSource({ lamp: [0, -128, 64] }));
        await shown(page, 2, 'final');
        const [left, right] = await halves(page);
        console.log(`left and right: ${before[1].map(Math.round)} before, ${[left, right].map(Math.round)} after`);
        assert.deepEqual(await camera(page), before[0]);
        assert.ok(before[1][0] > before[1][1] + 5, 'the lamp is on the left');
        assert.ok(right > left + 5, 'the lamp is on the right');
        assert.deepEqual(await page.evaluate(() => window.viewer.viewer.lightList.map(({ origin }) => origin)), [
            [0, -128, 64],
        ]);
    }));

test('a leak: its line and a place to go to', () =>
    follow('leak', roomSource({ hole: true }), async (page, map) => {
        await shown(page, 1, 'final');
        assert.ok(await page.evaluate(() => window.viewer.viewer.side.leak !== null));
        assert.equal(await page.textContent('#watch .head'), 'The map leaks');
        const before = await camera(page);
        await page.click('#watch li.error button >> nth=0');
        const first = await camera(page);
        assert.notDeepEqual(first, before);
        await page.click('#watch li.error button >> nth=0');
        assert.notDeepEqual(await camera(page), first, 'the next click follows the line');
        assert.match(await page.textContent('#watch ul'), /MAP LEAKED/);
        writeFileSync(map, roomSource({}));
        await shown(page, 2, 'final');
        assert.equal(await page.locator('#watch li').count(), 0);
        assert.ok(await page.evaluate(() => window.viewer.viewer.side.leak === null));
    }));

test('an error: the old picture stays', () =>
    follow('error', roomSource({}), async (page, map) => {
        await shown(page, 1, 'final');
        const before = await halves(page);
        writeFileSync(map, `${roomSource({})}{ "classname`);
        await page.waitForFunction(() => window.viewer.watch.state.stages.some(({ state }) => state === 'failed'));
        assert.equal(await page.textContent('#watch .head'), 'The build failed');
        assert.match(await page.textContent('#watch li.error'), /room\.map:\d+/);
        assert.deepEqual(await halves(page), before);
    }));

test('the watch ends: the page says so', () => {
    const { base, map } = makeGame('end', roomSource({}));
    return startWatch(process.env.PROGRAM, ['-fs_basepath', base, '-fs_nohomepath'], map).then((watch) =>
        withPage({}, async (page) => {
            await page.goto(watch.address);
            await shown(page, 1, 'final');
            assert.equal(await watch.end(), 0);
            await page.waitForFunction(() => window.viewer.watch.ended);
            assert.equal(await page.textContent('#watch .head'), 'The watch has ended');
        }),
    );
});
