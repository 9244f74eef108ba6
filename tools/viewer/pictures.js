// GPL-2.0-or-later. Draws the pictures of docs/guide/viewer.md again, from the demo arena baked with both SH grids.
//
// usage: node pictures.js DEMO.bsp REPORT.html
// made with -meta -keeplights, -vis, -light -shbspx -shadaptive -bounce 8 -bouncegrid;
// and then -shreport -explain -shbspx -shadaptive -bounce 8 -bouncegrid
import { join } from 'node:path';
import { openFiles, texturesLoaded, withPage } from './tests/browser.js';

const kOut = join(import.meta.dirname, '../../docs/pictures');

/** Opens the map, applies settings, moves the viewer, and takes a picture with these sections of the panel open.
 * height: of the page; the panel should fit. */
async function take(name, settings, place, open, height = 800) {
    await withPage({ viewport: { width: 1280, height } }, async (page) => {
        await openFiles(page, [process.argv[2]]);
        await texturesLoaded(page);
        await page.evaluate(
            ([values, at, sections]) => {
                const { viewer, panel } = window.viewer;
                Object.assign(viewer.settings, values);
                if (at) {
                    viewer.camera.position.fromArray(at.position);
                    [viewer.walk.yaw, viewer.walk.pitch] = [at.yaw, at.pitch];
                } else {
                    panel.fromAbove();
                }
                viewer.changed();
                panel.show();
                document.querySelectorAll('#panel details').forEach((details) => {
                    details.open = sections.includes(details.firstChild.textContent);
                });
            },
            [{ showPoints: true, ...settings }, place, open],
        );
        await page.waitForTimeout(500);
        await page.screenshot({ path: join(kOut, name), type: 'jpeg', quality: 80 });
    });
}

// Halfway between two columns of points, so that no sphere hides a figure.
const kBetweenLamps = { position: [-284, 32, 76], yaw: 0, pitch: -0.14 };
const kFigures = { figure: 'both', radius: 400, size: 0.6, source: 'sparse' };
await take('viewer.jpg', kFigures, kBetweenLamps, ['Light grid', 'Figure'], 924);
const kSlice = { where: 'slice', height: 64, thickness: 32, cut: true };
const kCells = { source: 'sparse', color: 'level', radius: 1536, size: 2, ...kSlice };
await take('viewer_cells.jpg', kCells, null, ['Light grid', 'Slice and errors']);

/** The box of a click on the floor, in a report with explanations. */
await withPage(
    { viewport: { width: 1280, height: 800 } },
    async (page) => {
        await page.waitForFunction(() => !document.getElementById('status').hidden);
        await texturesLoaded(page);
        await page.evaluate(() => {
            const { viewer } = window.viewer;
            viewer.camera.position.set(-380, -150, 150);
            [viewer.walk.yaw, viewer.walk.pitch] = [0.5, -0.42];
            viewer.invalidate();
        });
        await page.click('#toggle');
        await page.mouse.click(800, 560);
        await page.waitForTimeout(500);
        await page.screenshot({ path: join(kOut, 'viewer_explain.jpg'), type: 'jpeg', quality: 80 });
    },
    process.argv[3],
);
