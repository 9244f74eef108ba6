// GPL-2.0-or-later. Draws the pictures of docs/viewer.md again, from the demo arena baked with both SH grids.
//
// usage: node pictures.js DEMO.bsp    (-meta -keeplights, -vis, -light -shbspx -shadaptive)
import { join } from 'node:path';
import { openFiles, texturesLoaded, withPage } from './tests/browser.js';

const kOut = join(import.meta.dirname, '../../docs/pictures');

/** Opens the map, applies settings, moves the viewer, and takes a picture with these sections of the panel open. */
async function take(name, size, { settings, place, open, panel = true }) {
    const options =
        size.width < 600
            ? { viewport: size, hasTouch: true, isMobile: true, deviceScaleFactor: 2 }
            : { viewport: size };
    await withPage(options, async (page) => {
        await openFiles(page, [process.argv[2]]);
        await texturesLoaded(page);
        await page.evaluate(
            ([values, at, sections, shown]) => {
                const { viewer, panel: controls } = window.viewer;
                Object.assign(viewer.settings, values);
                if (at) {
                    viewer.camera.position.fromArray(at.position);
                    [viewer.walk.yaw, viewer.walk.pitch] = [at.yaw, at.pitch];
                } else {
                    controls.fromAbove();
                }
                viewer.changed();
                controls.show();
                document.querySelectorAll('#panel details').forEach((details) => {
                    details.open = sections.includes(details.firstChild.textContent);
                });
                if (shown !== !document.getElementById('panel').hidden) document.getElementById('toggle').click();
            },
            [settings, place ?? null, open, panel],
        );
        await page.waitForTimeout(500);
        await page.screenshot({ path: join(kOut, name), type: 'jpeg', quality: 88 });
    });
}

const kBetweenLamps = { position: [-290, 0, 64], yaw: 0, pitch: -0.06 };
await take(
    'viewer.jpg',
    { width: 1280, height: 800 },
    {
        settings: { figure: 'both', radius: 400, size: 0.8, source: 'sparse' },
        place: kBetweenLamps,
        open: ['Light grid', 'Figure'],
    },
);
await take(
    'viewer_cells.jpg',
    { width: 1280, height: 800 },
    {
        settings: {
            source: 'sparse',
            color: 'level',
            where: 'slice',
            height: 64,
            thickness: 32,
            radius: 1536,
            size: 2,
            cut: true,
            lights: true,
        },
        open: ['Light grid', 'Slice and errors'],
    },
);
await take(
    'viewer_phone.jpg',
    { width: 390, height: 780 },
    { settings: { radius: 256, size: 0.8 }, place: kBetweenLamps, open: [], panel: false },
);
