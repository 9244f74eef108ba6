// GPL-2.0-or-later. Draws the pictures of docs/guide/watch.md again, from the demo arena.
//
// usage: PROGRAM=build/bin/q3map2 node watch_pictures.js
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { withPage } from './tests/browser.js';
import { startWatch } from './tests/watching.js';

const root = join(import.meta.dirname, '../..');
const folder = mkdtempSync(join(tmpdir(), 'watch-pictures-'));
cpSync(join(root, 'tools/demo_data/demo_arena'), join(folder, 'demo'), { recursive: true });
const map = join(folder, 'demo/maps/demo.map');
const source = readFileSync(map, 'utf8');

/** The source with a piece of its text replaced. */
function replaced(piece, by) {
    if (!source.includes(piece)) throw new Error(`the demo arena has no ${piece}`);
    return source.replace(piece, by);
}

const eastWall = source.match(/\{\n\( 512 -400 320 \)[^}]*\}\n/)[0];
const kRoom = { position: [-100, 30, 150], yaw: Math.PI, pitch: -0.12 };
const kCourt = { position: [180, -30, 150], yaw: -0.1, pitch: -0.2 };

const watch = await startWatch(
    process.env.PROGRAM ?? join(root, 'build/bin/q3map2'),
    ['-fs_basepath', folder, '-fs_basegame', 'demo', '-fs_nohomepath'],
    map,
);

/** A picture from that place once the final light of the save is shown; `press`: an entry of the list. */
async function take(page, name, save, { position, yaw, pitch }, press = '') {
    await page.waitForFunction(
        (wanted) => {
            const { state, shown } = window.viewer.watch;
            return state?.save === wanted && state.pass === 'final' && shown === state.version && !state.running;
        },
        save,
        { timeout: 300000 },
    );
    if (press) await page.click(press);
    await page.evaluate(
        ([at, turn, tilt]) => {
            const { viewer } = window.viewer;
            viewer.camera.position.fromArray(at);
            Object.assign(viewer.walk, { yaw: turn, pitch: tilt });
            viewer.settings.brightness = 1.5;
            viewer.changed();
        },
        [position, yaw, pitch],
    );
    await page.waitForTimeout(800);
    await page.screenshot({ path: join(root, 'docs/pictures', name), type: 'jpeg', quality: 80 });
}

await withPage({ viewport: { width: 1100, height: 640 } }, async (page) => {
    await page.goto(watch.address);
    await page.waitForFunction(() => !document.getElementById('toggle').hidden);
    for (const id of ['#toggle', '#help']) await page.click(id); // the panel and the keys are in other pictures
    await take(page, 'watch_before.jpg', 1, kRoom);
    writeFileSync(map, replaced('"origin" "-264 -336 160"', '"origin" "-430 120 60"'));
    await take(page, 'watch_after.jpg', 2, kRoom);
    writeFileSync(map, replaced(eastWall, ''));
    await take(page, 'watch_leak.jpg', 3, kCourt, '#watch li.error button');
});
await watch.end();
rmSync(folder, { recursive: true });
