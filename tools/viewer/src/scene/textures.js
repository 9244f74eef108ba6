// GPL-2.0-or-later. Textures of surfaces, loaded while the map is already shown.
import * as THREE from 'three';
import { findImage, readImage } from '../files/images.js';

const kAtOnce = 6;

function solid(r, g, b) {
    const texture = new THREE.DataTexture(new Uint8Array([r, g, b, 255]), 1, 1);
    texture.needsUpdate = true;
    return texture;
}

/** An image as a texture with mipmaps; repeated unless clamped. */
function textureOf(image, clamp, anisotropy) {
    const texture = image.rgba
        ? new THREE.DataTexture(image.rgba, image.width, image.height)
        : new THREE.Texture(image);
    texture.flipY = false; // Quake's t runs down, like the rows of an image
    texture.wrapS = texture.wrapT = clamp ? THREE.ClampToEdgeWrapping : THREE.RepeatWrapping;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.magFilter = THREE.LinearFilter;
    texture.generateMipmaps = true;
    texture.anisotropy = anisotropy;
    texture.needsUpdate = true;
    return texture;
}

export class Textures {
    white = solid(255, 255, 255);
    missing = solid(148, 148, 152); // a plain wall: light can be judged on it
    /** @type {Map<string, THREE.Texture>} */
    loaded = new Map();
    absent = new Set();

    /** @param {number} anisotropy samples of the filter along slanted surfaces */
    constructor(anisotropy) {
        this.anisotropy = anisotropy;
    }

    /**
     * Loads images and hands each to its batches.
     * @param {{material: THREE.ShaderMaterial, image: string, clamp: boolean}[]} batches
     * @param {import('../files/game_files.js').GameFiles} files
     * @param {() => boolean} isCurrent false once another map is shown
     * @param {() => void} changed called after each texture
     */
    async loadAll(batches, files, isCurrent, changed) {
        const queue = batches.filter((batch) => batch.image !== '' && batch.image !== '$whiteimage');
        const work = async () => {
            for (let batch; isCurrent() && (batch = queue.shift());) {
                const texture = await this.load(batch.image, batch.clamp, files);
                if (!isCurrent()) return;
                batch.material.uniforms.image.value = texture;
                changed();
            }
        };
        await Promise.all(Array.from({ length: kAtOnce }, work));
    }

    /** Gives batches the textures that are loaded already. */
    apply(batches) {
        for (const { material, image, clamp } of batches) {
            const texture = this.loaded.get(`${image}|${clamp}`);
            if (texture) material.uniforms.image.value = texture;
        }
    }

    async load(image, clamp, files) {
        const key = `${image}|${clamp}`;
        const known = this.loaded.get(key);
        if (known) return known;
        const path = findImage(files, image);
        try {
            if (!path) throw new Error('absent');
            const texture = textureOf(await readImage(files, path), clamp, this.anisotropy);
            this.loaded.set(key, texture);
            return texture;
        } catch {
            this.absent.add(image);
            return this.missing;
        }
    }

    dispose() {
        for (const texture of this.loaded.values()) {
            texture.image?.close?.();
            texture.dispose();
        }
        this.loaded.clear();
        this.absent.clear();
    }
}
