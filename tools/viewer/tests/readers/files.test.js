// GPL-2.0-or-later. Images, shader scripts and files beside maps.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { parseErrors, parseExplanations, parseLeakLine, parsePortals, parseUnexplained } from '../../src/bsp/side_files.js';
import { baseName, extensionOf } from '../../src/files/opened.js';
import { readShader, splitScript } from '../../src/files/shader_script.js';
import { decodeTga } from '../../src/files/tga.js';
import { nearestPlace } from '../../src/scene/explained.js';
import { ontoSurfaces } from '../../src/scene/nearest_surface.js';

/** A TGA header; descriptor 32: first row on top. */
function tgaHead(kind, width, height, bits, descriptor, palette = 0) {
    return [
        0,
        palette ? 1 : 0,
        kind,
        0,
        0,
        palette,
        0,
        palette ? 24 : 0,
        0,
        0,
        0,
        0,
        width,
        0,
        height,
        0,
        bits,
        descriptor,
    ];
}

test('TGA: rows from below, blue first', () => {
    const { rgba } = decodeTga(Uint8Array.from([...tgaHead(2, 1, 2, 24, 0), 1, 2, 3, 4, 5, 6]), 'x.tga');
    assert.deepEqual([...rgba], [6, 5, 4, 255, 3, 2, 1, 255]);
});

test('TGA: run lengths, alpha, rows from above', () => {
    const { rgba } = decodeTga(
        Uint8Array.from([...tgaHead(10, 3, 1, 32, 40), 0x81, 1, 2, 3, 4, 0x00, 5, 6, 7, 8]),
        'x.tga',
    );
    assert.deepEqual([...rgba], [3, 2, 1, 4, 3, 2, 1, 4, 7, 6, 5, 8]);
});

test('TGA: gray and palettes', () => {
    assert.deepEqual([...decodeTga(Uint8Array.from([...tgaHead(3, 1, 1, 8, 0), 9]), 'x.tga').rgba], [9, 9, 9, 255]);
    const bytes = Uint8Array.from([...tgaHead(1, 2, 1, 8, 0, 2), 1, 2, 3, 4, 5, 6, 1, 0]);
    assert.deepEqual([...decodeTga(bytes, 'x.tga').rgba], [6, 5, 4, 255, 3, 2, 1, 255]);
});

test('TGA: damaged images are refused', () => {
    assert.throws(() => decodeTga(Uint8Array.from(tgaHead(2, 9, 9, 24, 0)), 'x.tga'), /x.tga is cut off/);
    assert.throws(() => decodeTga(Uint8Array.from(tgaHead(2, 0, 9, 24, 0)), 'x.tga'), /no valid size/);
    assert.throws(() => decodeTga(Uint8Array.of(1, 2), 'x.tga'), /header/);
});

const kScript = `
// a comment
textures/a/wall { surfaceparm nolightmap /* no */ { map $lightmap } { map textures/A/wall.tga
 blendFunc filter } }
textures/a/grate
{
	cull none
	{
		map textures/a/grate.tga
		alphaFunc GE128
	}
	{ map $lightmap
	  blendfunc GL_DST_COLOR GL_ZERO }
}
textures/a/glow { { clampmap textures/a/glow.tga
 blendfunc add
 tcMod scale 2 3 } }
textures/a/sky { surfaceparm sky
 skyparms env/x 512 - }
textures/a/clip { surfaceparm nodraw }
textures/a/lava { { animMap 2 textures/a/l1.tga textures/a/l2.tga } }
textures/a/outside { { map textures/a/shine.tga
 tcGen environment } { map maps/x/lm_0000.tga
 tcGen lightmap } { map textures/a/stone.tga
 blendFunc filter } }
`;

test('shader scripts', () => {
    const shaders = splitScript(kScript);
    const read = (key) => readShader(key, shaders.get(key));
    const wall = read('textures/a/wall');
    assert.deepEqual([wall.image, wall.blend, wall.light], ['textures/a/wall.tga', null, 'lightmap']);
    const grate = read('textures/a/grate');
    assert.deepEqual([grate.alphaTest, grate.twoSided, grate.light], [0.5, true, 'lightmap']);
    const glow = read('textures/a/glow');
    assert.deepEqual([glow.blend, glow.clamp, glow.light, glow.scale], ['add', true, 'none', [2, 3]]);
    assert.equal(read('textures/a/sky').sky, true);
    assert.equal(read('textures/a/clip').hidden, true);
    assert.equal(read('textures/a/lava').image, 'textures/a/l1.tga');
    const outside = read('textures/a/outside');
    assert.deepEqual(
        [outside.image, outside.lightmapImage, outside.light],
        ['textures/a/stone.tga', 'maps/x/lm_0000.tga', 'lightmap'],
    );
    assert.deepEqual([read('textures/a/none').image, read('textures/a/none').light], ['textures/a/none', 'any']);
});

test('leak lines and portals', () => {
    assert.deepEqual(parseLeakLine('1 2 3\n-4 5.5 6\n'), [
        [1, 2, 3],
        [-4, 5.5, 6],
    ]);
    assert.throws(() => parseLeakLine('1 2 3'), /three numbers/);
    const file = parsePortals('PRT1\n2\n1\n1\n3 0 1 1 (0 0 0 ) (0 0 8 ) (0 8 0 ) \n3 0 (1 0 0 ) (0 0 8 ) (0 8 0 ) \n');
    assert.deepEqual(file.portals, [
        {
            clusters: [0, 1],
            hint: true,
            points: [
                [0, 0, 0],
                [0, 0, 8],
                [0, 8, 0],
            ],
        },
    ]);
    assert.throws(() => parsePortals('PRT1\n2\n1\n0\n3 0 1 0 (0 0 0 )'), /ends early/);
    assert.throws(() => parsePortals('x'), /PRT1/);
});

test('errors of grids', () => {
    const text = JSON.stringify({
        format: 'q3map2-sh errors',
        version: 1,
        map: 'maps/x.bsp',
        unit: 'displayed bytes',
        positions: [[1, 2, 3, 0.5, 4]],
    });
    const errors = parseErrors(text);
    assert.deepEqual([[...errors.positions], errors.sh[0], errors.legacy[0]], [[1, 2, 3], 0.5, 4]);
    assert.throws(() => parseErrors('{'), /JSON/);
    assert.throws(() => parseErrors(text.replace('errors"', 'x"')), /not "q3map2-sh errors"/);
    assert.throws(() => parseErrors(text.replace('0.5', 'null')), /not five numbers/);
    assert.equal(parseErrors(text.replace('4]', 'null]')).legacy, null);
});

test('unexplained light', () => {
    const text = JSON.stringify({
        format: 'q3map2-sh unexplained light',
        version: 1,
        map: 'x',
        unit: 'bytes',
        positions: [
            [1, 2, 3, 0.5],
            [4, 5, 6, -7],
        ],
    });
    const { map, unit, count, positions, light } = parseUnexplained(text);
    assert.deepEqual([map, unit, count], ['x', 'bytes', 2]);
    assert.deepEqual([...positions, ...light], [1, 2, 3, 4, 5, 6, 0.5, -7]);
    assert.equal(parseUnexplained(text.replace(/"positions":.*/, '"positions":[]}')).count, 0);
    assert.throws(() => parseUnexplained('{'), /JSON/);
    assert.throws(() => parseUnexplained(text.replace('light"', 'x"')), /not "q3map2-sh unexplained light"/);
    assert.throws(() => parseUnexplained(text.replace('positions', 'places')), /no positions/);
    for (const fault of ['null', '"0.5"', '0.5,1', '[0.5]'])
        assert.throws(() => parseUnexplained(text.replace('0.5', fault)), /not four numbers/, fault);
    assert.equal(extensionOf('maps/X.Unexplained.json'), '.unexplained.json');
    assert.equal(baseName('maps/X.Unexplained.json'), 'X');
});

test('positions move onto the nearest surface, on their side of it', () => {
    // A floor of 128 units from the origin, seen from above, and a wall on its edge x = 0, seen from the floor.
    const vertices = Float32Array.of(0, 0, 0, 0, 128, 0, 128, 128, 0, 128, 0, 0, 0, 0, 128, 0, 128, 128);
    const mesh = { vertices, indexes: Uint32Array.of(0, 1, 2, 0, 2, 3, 0, 4, 5, 0, 5, 1) };
    const move = (at) => {
        const { positions, normals } = ontoSurfaces(Float32Array.from(at), [mesh], 8);
        return [...positions, ...normals].map((c) => c + 0); // no negative zeros
    };
    assert.deepEqual(move([90, 30, 1]), [90, 30, 0, 0, 0, 1]);
    assert.deepEqual(move([90, 30, -1]), [90, 30, 0, 0, 0, -1]);
    assert.deepEqual(move([90, 30, -0.25]), [90, 30, 0, 0, 0, 1]);
    assert.deepEqual(move([1, 30, 2]), [0, 30, 2, 1, 0, 0]);
    assert.deepEqual(move([132, 30, 3]), [128, 30, 0, 0, 0, 1]);
    assert.deepEqual(move([132, 30, 7]), [132, 30, 7, 0, 0, 0]);
    assert.deepEqual(move([90, 30, 9]), [90, 30, 9, 0, 0, 0]);
    assert.deepEqual(move([]), []);
});

test('explanations', () => {
    const place = { at: [0, 0, 24], on: [0, 0, 0], text: 'Lights', rays: [{ to: [9, 9, 9], visible: 0.5 }] };
    const text = (...places) =>
        JSON.stringify({ format: 'q3map2-sh explanations', version: 1, map: 'maps/x.bsp', options: '-sh', places });
    assert.deepEqual(parseExplanations(text(place)), { map: 'maps/x.bsp', options: '-sh', places: [place] });
    assert.throws(() => parseExplanations('['), /JSON/);
    assert.throws(() => parseExplanations(text(place).replace('"version":1', '"version":2')), /version 1/);
    for (const fault of [{ at: [0, 0] }, { text: 5 }, { rays: [{ to: [1, 2, 3] }] }, { on: null }])
        assert.throws(() => parseExplanations(text({ ...place, ...fault })), /not complete/);
    const stopped = { to: [9, 9, 9], visible: 0, stops: [[1, 2, 'x']] };
    assert.throws(() => parseExplanations(text({ ...place, rays: [stopped] })), /not complete/);
    assert.equal(extensionOf('maps/x.explain.json'), '.explain.json');
    assert.equal(baseName('maps/x.explain.json'), 'x');
});

test('the explained place of a click is the nearest one before the surface', () => {
    const up = { toArray: () => [0, 0, 1] };
    const point = { toArray: () => [20, 20, 0] };
    const over = { at: [80, 20, 24], on: [80, 20, 0] };
    const under = { at: [20, 20, -10], on: [20, 20, -2] };
    const wall = { at: [28, 20, 12], on: [4, 20, 12] };
    const find = (...places) => nearestPlace(places, { point, normal: up });
    assert.equal(find(under, over), over);
    assert.equal(find(under), under);
    assert.equal(find(wall, over), over);
    assert.equal(find(wall, { ...over, at: [180, 20, 24], on: [180, 20, 0] }), wall);
    assert.equal(find(), null);
});
