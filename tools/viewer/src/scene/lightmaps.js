// GPL-2.0-or-later. All lightmaps of a map as layers of one texture array.
import * as THREE from 'three';
import { findImage, readImage, texelsOf } from '../files/images.js';
import { kMapShift } from './glsl.js';

/** Writes one page into a layer, each texel shifted and, if too bright, scaled down to 255. */
function fillLayer(target, side, page) {
    const { width, height, texels, step, shift } = page;
    for (let y = 0; y < height; y++)
        for (let x = 0; x < width; x++) {
            const from = step * (y * width + x);
            const to = 4 * (y * side + x);
            const [r, g, b] = [texels[from] << shift, texels[from + 1] << shift, texels[from + 2] << shift];
            const factor = 255 / Math.max(255, r, g, b);
            target[to] = r * factor;
            target[to + 1] = g * factor;
            target[to + 2] = b * factor;
            target[to + 3] = 255;
        }
}

export class Lightmaps {
    /** Pages by number or path: layer, and the part of the layer that they fill. */
    places = new Map();
    /** Numbers and paths of pages that the map names but that were not found. */
    missing = new Set();

    /**
     * @param map from readMap
     * @param {string} name of the map, without folder and extension
     * @param {string[]} images paths of lightmaps that shaders name
     * @param {import('../files/game_files.js').GameFiles} files
     * @param {number} mostLayers limit of the graphics system
     */
    static async load(map, name, images, files, mostLayers) {
        const lightmaps = new Lightmaps();
        const pages = new Map();
        const side = map.lightmapSide;
        const pageBytes = 3 * side * side;
        for (let i = 0; pageBytes * (i + 1) <= map.lightmaps.length; i++)
            pages.set(i, {
                width: side,
                height: side,
                step: 3,
                shift: kMapShift,
                texels: map.lightmaps.subarray(pageBytes * i, pageBytes * (i + 1)),
            });
        const named = map.surfaces.flatMap((surface) => surface.lightmapStyles.map((_, slot) => surface.pages[slot]));
        for (const i of new Set(named.filter((number) => number >= 0 && !pages.has(number))))
            await lightmaps.addImage(pages, i, `maps/${name}/lm_${String(i).padStart(4, '0')}`, kMapShift, files);
        for (const path of images) await lightmaps.addImage(pages, path, path, 0, files);
        lightmaps.makeTexture([...pages].slice(0, mostLayers));
        for (const [key] of [...pages].slice(mostLayers)) lightmaps.missing.add(key);
        return lightmaps;
    }

    async addImage(pages, key, path, shift, files) {
        const found = findImage(files, path);
        try {
            const image = found && (await readImage(files, found));
            if (image)
                pages.set(key, { width: image.width, height: image.height, step: 4, shift, texels: texelsOf(image) });
            else this.missing.add(key);
        } catch {
            this.missing.add(key);
        }
    }

    makeTexture(pages) {
        const side = Math.max(1, ...pages.map(([, page]) => Math.max(page.width, page.height)));
        const layerBytes = 4 * side * side;
        const data = new Uint8Array(layerBytes * Math.max(1, pages.length));
        pages.forEach(([key, page], layer) => {
            fillLayer(data.subarray(layerBytes * layer, layerBytes * (layer + 1)), side, page);
            this.places.set(key, { layer, scale: [page.width / side, page.height / side], texel: 0.5 / side });
        });
        this.texture = new THREE.DataArrayTexture(data, side, side, Math.max(1, pages.length));
        this.texture.minFilter = this.texture.magFilter = THREE.LinearFilter;
        this.texture.needsUpdate = true;
        this.count = pages.length;
    }

    /**
     * Where the lightmaps of a surface are, by slot; undefined where it has none. An image that its shader names stands
     * for all of them.
     */
    placesOf(surface, shader) {
        if (shader.lightmapImage) return [this.places.get(shader.lightmapImage)];
        return surface.lightmapStyles.map((_, slot) => this.places.get(surface.pages[slot]));
    }
}
