// GPL-2.0-or-later. Which explained place a click on a surface means.

const kAlike = 0.7; // cosine of the largest angle between two normals that count as the same way
const kOtherWay = 64; // units that a place in front of a surface that faces another way counts as farther
const kBehind = 1e6; // the same for a place behind the surface: more than maps are large

const dot = (u, v) => u.reduce((sum, x, axis) => sum + x * v[axis], 0);
const difference = (u, v) => u.map((x, axis) => x - v[axis]);

/**
 * The explained place nearest to the point of a surface that was clicked, of those in front of surfaces that face the
 * same way; a place behind the surface, such as one in the next room, only if there is no other. Null: there are no places.
 * @param {import('../bsp/side_files.js').Place[]} places
 * @param {{point: {toArray: () => number[]}, normal: {toArray: () => number[]}}} picked of MapMesh.surfaceOn
 */
export function nearestPlace(places, picked) {
    const [clicked, normal] = [picked.point.toArray(), picked.normal.toArray()];
    let [best, least] = [null, Infinity];
    for (const place of places) {
        const offset = difference(place.at, clicked);
        const facing = difference(place.at, place.on);
        const facesAlike = dot(facing, normal) > kAlike * Math.hypot(...facing);
        const isBehind = dot(offset, normal) < 0;
        const cost = Math.hypot(...offset) + (facesAlike ? 0 : kOtherWay) + (isBehind ? kBehind : 0);
        if (cost < least) [best, least] = [place, cost];
    }
    return best;
}
