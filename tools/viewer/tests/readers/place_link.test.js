// GPL-2.0-or-later. Addresses that lead to a place in a map.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { linkTo, placeOf } from '../../src/place_link.js';

test('a link leads back to its place', () => {
    const link = linkTo('maps/my map&x.bsp', [-264.04, 0, 58.96], Math.PI / 2, -Math.PI / 4);
    assert.equal(link, '#map=maps/my%20map%26x.bsp&at=-264,0,59,90,-45');
    const place = placeOf(link, 'maps/my map&x.bsp');
    assert.deepEqual(place.position, [-264, 0, 59]);
    assert.ok(Math.abs(place.yaw - Math.PI / 2) < 1e-9 && Math.abs(place.pitch + Math.PI / 4) < 1e-9);
});

test('the folder and the case of the map do not matter, another map does', () => {
    assert.ok(placeOf('#map=maps/X.bsp&at=1,2,3,4,5', 'x.bsp'));
    assert.ok(placeOf('#at=1,2,3,4,5', 'x.bsp'));
    assert.equal(placeOf('#map=maps/y.bsp&at=1,2,3,4,5', 'x.bsp'), null);
});

test('what is not a place is none', () => {
    for (const hash of ['', '#', '#at=', '#at=1,2,3', '#at=1,2,3,4,', '#at=1,2,3,4,x', '#at=1,2,3,4,Infinity'])
        assert.equal(placeOf(hash, 'x.bsp'), null, hash);
    assert.equal(placeOf('#at=0,0,0,0,1000', 'x.bsp').pitch, Math.PI / 2);
});
