// GPL-2.0-or-later. The built page in Chromium, with the demo arena and, if they are there, with real maps.
// DEMO and REAL name baked maps with both SH grids, TONED one with a tone and the uniform grid; PROBE the compiled
// probe.c; EXTERNAL the arena with lightmaps in images beside it; REPORT a page of -shreport -explain; REAL_PK3
// archives, separated by ':'.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { zipSync } from 'fflate';
import { readGrids } from '../src/bsp/grids.js';
import { readMap } from '../src/bsp/map.js';
import { BspTree } from '../src/bsp/tree.js';
import { kPage, openFiles, texturesLoaded, withPage } from './browser.js';
import { makeBsp, roomLumps, styledLumps } from './readers/make_bsp.js';

const { DEMO, TONED, EXTERNAL, REPORT, REAL, PROBE } = process.env;
const kDesktop = { viewport: { width: 1024, height: 640 } };
const kPhone = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };
const kProbes = 20;
const kMostDifference = 2; // bytes of 255, mean over probes and channels
const kMostFirstPicture = 3000; // ms
let folder;

before(() => {
    folder = mkdtempSync(join(tmpdir(), 'viewer-test-'));
});
after(() => rmSync(folder, { recursive: true }));

const messages = (page) => page.locator('.message').allTextContents();

function write(name, content) {
    const path = join(folder, name);
    writeFileSync(path, content);
    return path;
}

/** A file of unexplained light. */
function unexplained(map, positions) {
    return JSON.stringify({ format: 'q3map2-sh unexplained light', version: 1, map, unit: 'bytes', positions });
}

/** Points in the open, neither dark nor too bright for the screen, whose sphere the viewer can stand before, evenly over
 * the grid, and where it stands. */
function choosePoints(path, form) {
    const map = readMap(new Uint8Array(readFileSync(path)));
    const tree = new BspTree(map.tree);
    const grid = readGrids(map)[form];
    const lit = [];
    for (let i = 0; i < grid.count; i++) {
        const brightest = Math.max(...grid.coeffs(i).slice(0, 3)); // 0.9: displayed as white by the overbright bits
        if (tree.clusterAt(...grid.position(i)) >= 0 && brightest > 0.05 && brightest < 0.9) lit.push(i);
    }
    assert.ok(lit.length >= kProbes);
    return Array.from({ length: kProbes }, (_, k) => {
        const i = lit[Math.floor(((k + 0.5) * lit.length) / kProbes)];
        const [yaw, pitch] = [2.4 * k, 0.9 * Math.sin(1.7 * k)];
        const normal = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
        const distance = 5 * 0.11 * grid.size(i);
        const center = grid.position(i);
        return { center, normal, yaw, pitch, eye: center.map((c, axis) => c + distance * normal[axis]) };
    });
}

/** Displayed bytes at the centers of spheres by the reader for engines. */
function expectedColors(path, form, points) {
    const input = points.map(({ center, normal }) => [...center, ...normal].join(' ')).join('\n');
    const tone = readMap(new Uint8Array(readFileSync(path))).entities[0].get('_q3map2_tone') ?? '';
    return execFileSync(PROBE, [path, form, tone], { input })
        .toString()
        .trim()
        .split('\n')
        .map((line) => line.split(' ').slice(27).map(Number));
}

/** Color of the middle of the picture with the viewer before each point, the map hidden. */
async function shownColors(page, form, points) {
    return page.evaluate(
        ([source, list]) => {
            const { viewer } = window.viewer;
            Object.assign(viewer.settings, {
                source,
                showPoints: true,
                color: 'light',
                where: 'near',
                radius: 96,
                size: 1,
                brightness: 1,
                figure: 'off',
                inWalls: true,
            });
            viewer.mesh.group.visible = false;
            const gl = viewer.renderer.getContext();
            const colors = list.map(({ eye, yaw, pitch }) => {
                viewer.camera.position.fromArray(eye);
                viewer.walk.yaw = yaw + Math.PI;
                viewer.walk.pitch = -pitch;
                viewer.changed();
                viewer.drawNow();
                const pixel = new Uint8Array(4);
                gl.readPixels(
                    gl.drawingBufferWidth >> 1,
                    gl.drawingBufferHeight >> 1,
                    1,
                    1,
                    gl.RGBA,
                    gl.UNSIGNED_BYTE,
                    pixel,
                );
                return [...pixel.slice(0, 3)];
            });
            viewer.mesh.group.visible = true;
            return colors;
        },
        [form, points],
    );
}

async function compareSpheres(page, path, form) {
    const points = choosePoints(path, form);
    const expected = expectedColors(path, form, points);
    const shown = await shownColors(page, form, points);
    const differences = shown.flatMap((color, i) => color.map((c, k) => Math.abs(c - expected[i][k])));
    const mean = differences.reduce((sum, d) => sum + d, 0) / differences.length;
    console.log(`${form}: mean difference ${mean.toFixed(3)}, largest ${Math.max(...differences).toFixed(2)} of 255`);
    assert.ok(new Set(shown.map(String)).size > kProbes / 2, `the probes show too few colors: ${shown.join(' | ')}`);
    assert.ok(mean <= kMostDifference, `${form}: mean difference ${mean}`);
}

/** Sets every control of the panel to another value and back. */
async function toggleAll(page) {
    const calls = await page.evaluate(() => {
        const { viewer, panel } = window.viewer;
        document.querySelectorAll('#panel details').forEach((details) => {
            details.open = true;
        });
        const drawn = [];
        for (const input of document.querySelectorAll('#panel input:not(:disabled)')) {
            const old = [input.checked, input.value];
            if (input.type === 'range') input.value = Number(input.max);
            if (input.type === 'range') input.dispatchEvent(new Event('input'));
            else input.click();
            viewer.drawNow();
            drawn.push(viewer.stats.calls);
            if (input.type === 'checkbox') input.click();
            if (input.type === 'range') {
                input.value = old[1];
                input.dispatchEvent(new Event('input'));
            }
        }
        panel.show();
        return drawn;
    });
    assert.ok(calls.length > 20);
    assert.ok(
        calls.every((n) => n > 0 && n < 200),
        `draw calls: ${calls}`,
    );
}

async function moveByKeys(page) {
    const position = () => page.evaluate(() => window.viewer.viewer.camera.position.toArray());
    const before = await position();
    await page.focus('#view');
    for (const key of ['KeyW', 'KeyE', 'ArrowLeft']) {
        await page.keyboard.down(key);
        await page.waitForTimeout(600);
        await page.keyboard.up(key);
    }
    const afterwards = await position();
    assert.ok(Math.hypot(...afterwards.map((c, i) => c - before[i])) > 30, 'keys did not move the viewer');
    await page.keyboard.down('KeyW');
    await page.keyboard.down('Shift');
    assert.equal(await page.evaluate(() => window.viewer.viewer.walk.fast), true, 'Shift after the key counts');
    await page.keyboard.up('Shift');
    assert.equal(await page.evaluate(() => window.viewer.viewer.walk.fast), false);
    await page.keyboard.up('KeyW');
    assert.match(await page.textContent('#status'), /\d+ fps · \d+ draw calls · first picture \d+ ms/);
}

test('the demo arena: shown, moved through, every control, spheres', { skip: !DEMO || !PROBE }, () =>
    withPage(kDesktop, async (page, faults) => {
        await openFiles(page, [DEMO]);
        await texturesLoaded(page);
        assert.deepEqual(await messages(page), []);
        assert.equal(await page.textContent('#title'), DEMO.split('/').pop());
        await moveByKeys(page);
        await compareSpheres(page, DEMO, 'uniform');
        await compareSpheres(page, DEMO, 'sparse');
        await toggleAll(page);
        assert.deepEqual(faults, []);
    }),
);

test('a map with a tone: spheres', { skip: !TONED || !PROBE }, () =>
    withPage(kDesktop, async (page, faults) => {
        await openFiles(page, [TONED]);
        await texturesLoaded(page);
        await compareSpheres(page, TONED, 'uniform');
        assert.deepEqual(faults, []);
    }),
);

/** Mean color of the picture without spheres, in bytes. */
function meanColor(page) {
    return page.evaluate(() => {
        const { viewer } = window.viewer;
        viewer.settings.showPoints = false;
        viewer.changed();
        viewer.drawNow();
        const gl = viewer.renderer.getContext();
        const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
        const pixels = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return [0, 1, 2].map(
            (c) => pixels.reduce((sum, byte, i) => sum + (i % 4 === c ? byte : 0), 0) / (width * height),
        );
    });
}

test('lightmaps in images beside the map look like those inside', { skip: !DEMO || !EXTERNAL }, async () => {
    const images = EXTERNAL.replace(/\.bsp$/, '');
    const entries = readdirSync(images).map((name) => [
        `maps/external/${name}`,
        new Uint8Array(readFileSync(join(images, name))),
    ]);
    const archive = zipSync({
        'maps/external.bsp': new Uint8Array(readFileSync(EXTERNAL)),
        ...Object.fromEntries(entries),
    });
    const colors = [];
    for (const path of [DEMO, write('external.pk3', archive)])
        await withPage(kDesktop, async (page, faults) => {
            await openFiles(page, [path]);
            await texturesLoaded(page);
            assert.ok(
                await page.evaluate(
                    () => window.viewer.viewer.lightmaps.count > 0 && window.viewer.viewer.lightmaps.missing.size === 0,
                ),
            );
            colors.push(await meanColor(page));
            assert.deepEqual(faults, []);
        });
    console.log(`mean colors ${colors.map((color) => color.map((c) => c.toFixed(1)).join(' ')).join(' and ')}`);
    assert.ok(Math.max(...colors[0]) > 20);
    colors[0].forEach((c, k) => assert.ok(Math.abs(c - colors[1][k]) < 3));
});

/** Color of the middle of the picture from below the triangle of roomLumps, with a share of each light style. */
function colorOfTriangle(page, styleLight) {
    return page.evaluate((shares) => {
        const { viewer } = window.viewer;
        viewer.settings.textured = false;
        for (const [style, share] of Object.entries(shares)) viewer.settings.styleLight[style] = share;
        viewer.camera.position.set(20, 20, -30);
        viewer.walk.pitch = Math.PI / 2;
        viewer.changed();
        viewer.drawNow();
        const gl = viewer.renderer.getContext();
        const pixel = new Uint8Array(4);
        const middle = [gl.drawingBufferWidth >> 1, gl.drawingBufferHeight >> 1];
        gl.readPixels(...middle, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return [...pixel.slice(0, 3)];
    }, styleLight);
}

/** Sets the slider of a light style in the panel. */
function setStyle(page, index, value) {
    const slider = page.locator('#panel details', { hasText: 'Light styles' }).locator('input[type=range]').nth(index);
    return slider.evaluate((input, share) => {
        input.value = share;
        input.dispatchEvent(new Event('input'));
    }, value);
}

for (const [what, ident, pages, side, world] of [
    ['lightmaps of RBSP', 'RBSP', [0, 1, -3, -3], 128, ''],
    ['lightmaps of FBSP', 'FBSP', [0, 1, -3, -3], 512, ''],
    ['lightmaps of FBSP with pages of a side of its own', 'FBSP', [0, 1, -3, -3], 64, '"_lightmapimagesize" "64"'],
    ['vertices of RBSP', 'RBSP', [-3, -3, -3, -3], 128, ''],
])
    test(`light styles on ${what}`, () =>
        withPage(kDesktop, async (page, faults) => {
            await openFiles(page, [write('styled.bsp', makeBsp(1, styledLumps(pages, side, world), [], ident))]);
            await texturesLoaded(page);
            const near = (actual, expected) =>
                assert.ok(actual.every((c, k) => Math.abs(c - expected[k]) <= 2), `${actual} is not ${expected}`);
            near(await colorOfTriangle(page, {}), [40, 80, 120]); // four times, by the overbright bits
            near(await colorOfTriangle(page, { 0: 1, 33: 0.5 }), [120, 80, 124]);
            near(await colorOfTriangle(page, { 0: 0, 33: 1 }), [160, 0, 8]);
            await page.click('text=Light styles');
            assert.equal(await page.isVisible('text=33: lamp'), true);
            await setStyle(page, 0, 1);
            await setStyle(page, 1, 0.25);
            const shares = await page.evaluate(() => [...window.viewer.viewer.settings.styleLight]);
            assert.deepEqual([shares[0], shares[33]], [1, 0.25]);
            near(await colorOfTriangle(page, {}), [80, 80, 122]);
            await page.click('text=All on');
            near(await colorOfTriangle(page, {}), [200, 80, 128]);
            assert.match(await page.textContent('#panel .facts'), new RegExp(`File${ident} 1,`));
            await openFiles(page, [write('room.bsp', makeBsp(46, roomLumps()))]);
            await page.waitForFunction(() => document.getElementById('title').textContent === 'room.bsp');
            assert.equal(await page.isVisible('text=Light styles'), false);
            near(await colorOfTriangle(page, {}), [40, 80, 120]);
            assert.deepEqual(await messages(page), []);
            assert.deepEqual(faults, []);
        }),
    );

test('a click tells what a surface is; a link leads back; the picture is saved', { skip: !DEMO }, () =>
    withPage({ ...kDesktop, acceptDownloads: true }, async (page, faults) => {
        await openFiles(page, [DEMO]);
        await texturesLoaded(page);
        assert.equal(await page.isVisible('#keys'), true);
        assert.equal(await page.evaluate(() => window.viewer.viewer.settings.showPoints), false);
        await page.evaluate(() => {
            const { viewer } = window.viewer;
            viewer.camera.position.set(-264, 0, 58);
            [viewer.walk.yaw, viewer.walk.pitch] = [0.5, -1.2]; // at the floor
            viewer.drawNow(); // a click needs the camera to be there
        });
        await page.mouse.click(300, 400);
        await page.waitForFunction(() => document.getElementById('surface').textContent !== '');
        const text = await page.textContent('#surface');
        assert.match(text, /textures\/demo\/.*planar.*page \d.*\d units/);
        const { surface, point } = await page.evaluate(() => window.viewer.viewer.picked);
        assert.ok(Number.isInteger(surface) && Math.abs(point.z) < 1, `the floor is at height 0: ${point.z}`);
        await page.keyboard.press('Escape');
        await page.waitForFunction(() => document.getElementById('surface').hidden);
        await page.click('text=Copy link');
        await page.waitForFunction(() => location.hash.includes('at=-264,0,58,28.6,-68.8'));
        await page.evaluate(() => {
            location.hash = 'at=10,20,30,90,0';
        });
        await page.waitForFunction(() => window.viewer.viewer.camera.position.z === 30);
        const saved = page.waitForEvent('download');
        await page.click('text=Save picture');
        assert.equal((await saved).suggestedFilename(), `${DEMO.split('/').pop().replace('.bsp', '')}_10_20_30.png`);
        await page.click('text=Luxel size');
        await page.waitForFunction(() => document.getElementById('legend').textContent.includes('no lightmap'));
        assert.deepEqual(faults, []);
    }),
);

test('a click in a report with explanations tells why a surface is lit as it is', { skip: !REPORT }, () =>
    withPage(
        kDesktop,
        async (page, faults) => {
            await page.waitForFunction(() => !document.getElementById('status').hidden);
            await texturesLoaded(page);
            await page.evaluate(() => {
                const { viewer } = window.viewer;
                viewer.camera.position.set(-264, 0, 58);
                [viewer.walk.yaw, viewer.walk.pitch] = [0.5, -1.2]; // at the floor
                viewer.drawNow(); // a click needs the camera to be there
            });
            await page.mouse.click(300, 400);
            await page.waitForFunction(() => document.querySelector('#surface .explanation'));
            const { at, on, away, rays } = await page.evaluate(() => {
                const { explained, picked, side } = window.viewer.viewer;
                const away = Math.hypot(...explained.at.map((c, axis) => c - picked.point.toArray()[axis]));
                return { ...explained, away, rays: side.rays !== null };
            });
            assert.ok(Math.abs(at[2] - 24) < 1 && Math.abs(on[2]) < 1, `before the floor: ${at} at ${on}`);
            assert.ok(away < 100 && rays, `${away} units away`);
            const text = await page.textContent('#surface .explanation');
            assert.ok(text.includes(`Lights at ${at.join(' ')}.`), text);
            assert.match(text, /Nearest luxel: surface \d+.*q3map2 -light -sh -explain -?\d+ -?\d+ -?\d+ maps\/demo.bsp/s);
            assert.equal(await page.isEnabled('input[name=places]'), true);
            await page.keyboard.press('Escape');
            await page.waitForFunction(() => document.getElementById('surface').hidden);
            assert.equal(await page.evaluate(() => window.viewer.viewer.side.rays), null);
            assert.deepEqual(await messages(page), []);
            assert.deepEqual(faults, []);
        },
        REPORT,
    ),
);

test('files beside the map, in a second drop', { skip: !DEMO }, () =>
    withPage(kDesktop, async (page, faults) => {
        await openFiles(page, [DEMO]);
        await openFiles(page, [
            write('demo.lin', '0 0 0\n64 0 0\n64 64 0\n'),
            write('demo.prt', 'PRT1\n2\n1\n0\n4 0 1 0 (0 0 0 ) (0 64 0 ) (0 64 64 ) (0 0 64 ) \n'),
            write(
                'demo.sherror.json',
                JSON.stringify({
                    format: 'q3map2-sh errors',
                    version: 1,
                    map: 'maps/demo.bsp',
                    unit: 'displayed bytes',
                    positions: [
                        [0, 0, 64, 1, 5],
                        [9, 9, 64, 2, 9],
                    ],
                }),
            ),
            write('demo.unexplained.json', unexplained('demo', [[-264, 0, 1, 3], [-232, 0, 1, -4]])),
        ]);
        await page.waitForFunction(
            () =>
                window.viewer.viewer.errors.errors &&
                window.viewer.viewer.unexplained.light &&
                window.viewer.viewer.side.leak &&
                window.viewer.viewer.side.portals,
        );
        await page.waitForFunction(() => document.getElementById('legend').textContent.includes('displayed bytes'));
        assert.match(await page.textContent('#legend'), /explained light, in bytes/);
        await toggleAll(page);
        const at = await page.evaluate(() => window.viewer.viewer.camera.position.toArray());
        await openFiles(page, [write('more.pk3', zipSync({ 'textures/x.txt': new Uint8Array(1) }))]);
        await page.waitForFunction(
            () =>
                window.viewer.opener.files.archives.length === 1 &&
                window.viewer.viewer.side.leak &&
                window.viewer.viewer.stats.texturesDone > 0,
        );
        assert.deepEqual(await page.evaluate(() => window.viewer.viewer.camera.position.toArray()), at);
        assert.deepEqual(await messages(page), []);
        assert.deepEqual(faults, []);
    }),
);

test('unexplained light: dots on their surface, by sign and size', () =>
    withPage(kDesktop, async (page, faults) => {
        await openFiles(page, [write('room.bsp', makeBsp(46, roomLumps()))]);
        await texturesLoaded(page);
        const plain = await colorOfTriangle(page, {});
        const difference = (color) => Math.max(...color.map((c, k) => Math.abs(c - plain[k])));
        const colorOf = async (light) => {
            const rows = [[20, 20, -1, light]]; // in front of the triangle, which is seen from below
            await openFiles(page, [write('room.unexplained.json', unexplained('room', rows))]);
            await page.waitForFunction((value) => window.viewer.viewer.unexplained.light?.light[0] === value, light);
            return colorWith({ mostUnexplained: 8 });
        };
        const colorWith = async (settings) => {
            await page.evaluate((values) => Object.assign(window.viewer.viewer.settings, values), settings);
            return colorOfTriangle(page, {});
        };
        const summary = () => page.evaluate(() => window.viewer.viewer.unexplainedSummary);
        assert.ok(difference(await colorOf(0)) < 16, 'what is explained hardly shows');
        const darker = await colorOf(-9);
        assert.ok(darker[2] > 200 && darker[0] < 60, `blue: ${darker}`);
        const lighter = await colorOf(8);
        assert.ok(lighter[0] > 200 && lighter[2] < 60, `red: ${lighter}`);
        assert.deepEqual(await summary(), { count: 1, rms: 8 });
        await colorWith({ cut: true, height: -100 });
        assert.deepEqual(await summary(), { count: 0, rms: 0 });
        assert.deepEqual(await colorWith({ cut: false }), lighter);
        await page.waitForFunction(() => document.getElementById('legend').textContent.includes('8+ lighter'));
        assert.match(await page.textContent('#legend'), /explained light, in bytes8\+ darkeras explained8\+ lighter/);
        await page.click('summary:text("Unexplained light")');
        assert.equal(await page.isVisible('text=1 luxels, RMS 8.00 bytes'), true);
        await page.click('text=Luxels as dots');
        await page.waitForFunction(() => document.getElementById('legend').hidden);
        assert.deepEqual(await colorWith({}), plain);
        await openFiles(page, [write('room.unexplained.json', unexplained('other', [[0, 0, 0, 1]]))]);
        await page.waitForSelector('.message');
        assert.match((await messages(page)).join('\n'), /The unexplained light is of other, not/);
        assert.deepEqual(faults, []);
    }),
);

test('a drop opens the map', { skip: !DEMO }, () =>
    withPage(kDesktop, async (page, faults) => {
        await page.evaluate((base64) => {
            const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
            const transfer = new DataTransfer();
            transfer.items.add(new File([bytes], 'dropped.bsp'));
            document
                .getElementById('view')
                .dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
        }, readFileSync(DEMO).toString('base64'));
        await page.waitForFunction(() => document.getElementById('title').textContent === 'dropped.bsp');
        assert.deepEqual(await messages(page), []);
        assert.deepEqual(faults, []);
    }),
);

test('a report page opens its package', { skip: !DEMO }, async () => {
    const archive = zipSync({
        'maps/arène.bsp': new Uint8Array(readFileSync(DEMO)),
        'maps/arène.lin': new TextEncoder().encode('0 0 0\n64 0 0\n'),
        'maps/arène.unexplained.json': new TextEncoder().encode(unexplained('arène', [[-264, 0, 1, 3]])),
    });
    const marker = '<!-- package -->';
    const page = readFileSync(kPage, 'utf8');
    assert.equal(page.split(marker).length, 2);
    const base64 = Buffer.from(archive).toString('base64');
    const element = `<script type="application/zip;base64" id="package" data-map="maps/arène.bsp">${base64}</script>`;
    await withPage(
        kDesktop,
        async (shown, faults) => {
            await shown.waitForFunction(() => !document.getElementById('status').hidden);
            assert.equal(await shown.textContent('#title'), 'maps/arène.bsp');
            assert.ok(await shown.evaluate(() => window.viewer.viewer.side.leak !== null));
            assert.equal(await shown.evaluate(() => window.viewer.viewer.unexplained.light.count), 1);
            assert.deepEqual(await messages(shown), []);
            assert.deepEqual(faults, []);
        },
        write(
            'report.html',
            page.replace(marker, () => element),
        ),
    );
});

test('damaged and foreign files give a message, and no console error', { skip: !DEMO }, () =>
    withPage(kDesktop, async (page, faults) => {
        const bytes = readFileSync(DEMO);
        const cases = [
            ['text.bsp', Buffer.from('this is no map'), /not a Quake 3 map/],
            ['old.bsp', Buffer.concat([Buffer.from('IBSP&\0\0\0'), Buffer.alloc(200)]), /version 38/],
            ['raven.bsp', Buffer.concat([Buffer.from('RBSP.\0\0\0'), Buffer.alloc(200)]), /RBSP of version 46/],
            ['cut.bsp', bytes.subarray(0, 5000), /outside the file/],
            ['bad.pk3', Buffer.from('PK'), /not a pk3/],
            ['notes.txt', Buffer.from('x'), /not a file that this page opens/],
            ['x.lin', Buffer.from('0 0 0\n1 1 1'), /Open the map before/],
        ];
        for (const [name, content, pattern] of cases) {
            await openFiles(page, [write(name, content)]);
            assert.match((await messages(page)).join('\n'), pattern);
        }
        const damaged = Buffer.from(bytes);
        const lump = bytes.indexOf('SHGS');
        damaged.writeUInt32LE(99, lump + 48);
        await openFiles(page, [write('damaged.bsp', damaged)]);
        await page.waitForFunction(() => window.viewer.viewer.map);
        await page.waitForSelector('.message');
        assert.match((await messages(page)).join('\n'), /99 levels.*shown without it/);
        assert.deepEqual(faults, []);
    }),
);

test('touch: one finger looks, two move, the pad moves', { skip: !DEMO }, () =>
    withPage(kPhone, async (page, faults) => {
        await openFiles(page, [DEMO]);
        const state = () =>
            page.evaluate(() => ({
                yaw: window.viewer.viewer.walk.yaw,
                at: window.viewer.viewer.camera.position.toArray(),
            }));
        const client = await page.context().newCDPSession(page);
        const touch = (type, points) =>
            client.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
        const first = await state();
        await touch('touchStart', [[200, 300]]);
        await touch('touchMove', [[260, 300]]);
        await touch('touchEnd', []);
        const looked = await state();
        assert.ok(Math.abs(looked.yaw - first.yaw) > 0.1);
        await touch('touchStart', [
            [150, 300],
            [250, 300],
        ]);
        await touch('touchMove', [
            [110, 300],
            [290, 300],
        ]);
        await touch('touchEnd', []);
        const moved = await state();
        assert.ok(Math.hypot(...moved.at.map((c, i) => c - looked.at[i])) > 20);
        const stick = await page.locator('.stick').boundingBox();
        const [x, y] = [stick.x + stick.width / 2, stick.y + stick.height / 2];
        await touch('touchStart', [[x, y]]);
        await touch('touchMove', [[x, y - 40]]);
        await page.waitForTimeout(500);
        await touch('touchEnd', []);
        const padded = await state();
        assert.ok(Math.hypot(...padded.at.map((c, i) => c - moved.at[i])) > 20);
        await page.tap('#toggle');
        assert.equal(await page.isVisible('#panel'), true);
        assert.deepEqual(faults, []);
    }),
);

test('a real map: first picture, spheres, every control', { skip: !REAL || !PROBE }, () =>
    withPage(kDesktop, async (page, faults) => {
        const archives = (process.env.REAL_PK3 ?? '').split(':').filter(Boolean);
        await openFiles(page, [REAL, ...archives]);
        await texturesLoaded(page);
        const { firstPicture, texturesDone } = await page.evaluate(() => window.viewer.viewer.stats);
        console.log(`first picture ${firstPicture.toFixed(0)} ms, all textures ${texturesDone.toFixed(0)} ms`);
        assert.ok(firstPicture < kMostFirstPicture);
        assert.ok(archives.length === 0 || (await page.evaluate(() => window.viewer.viewer.textures.loaded.size)) > 5);
        await moveByKeys(page);
        for (const form of ['uniform', 'sparse']) await compareSpheres(page, REAL, form);
        await toggleAll(page);
        assert.deepEqual(faults, []);
    }),
);
