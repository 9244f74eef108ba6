// GPL-2.0-or-later. Images of a game: TGA is decoded by tga.js, others by the browser.
import { decodeTga } from './tga.js';

const kExtensions = ['tga', 'jpg', 'png', 'jpeg', 'webp'];
const kTypes = { jpg: 'image/jpeg', jpeg: 'image/jpeg', png: 'image/png', webp: 'image/webp' };

/** The file of an image that is named without extension or with another one; null if there is none. */
export function findImage(files, path) {
    if (files.has(path) && kExtensions.some((extension) => path.endsWith(`.${extension}`))) return path;
    const base = path.replace(/\.(tga|jpe?g|png|webp)$/, '');
    return kExtensions.map((extension) => `${base}.${extension}`).find((candidate) => files.has(candidate)) ?? null;
}

/**
 * @param {import('./game_files.js').GameFiles} files
 * @param {string} path from findImage
 * @returns an ImageBitmap, or for TGA {width, height, rgba}; first row on top
 * @throws if the image is damaged
 */
export async function readImage(files, path) {
    const bytes = await files.read(path);
    const extension = path.slice(path.lastIndexOf('.') + 1);
    if (extension === 'tga') return decodeTga(bytes, path);
    const blob = new Blob([bytes], { type: kTypes[extension] });
    return createImageBitmap(blob, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
}

/** Texels of an image as RGBA. */
export function texelsOf(image) {
    if (image.rgba) return image.rgba;
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    return new Uint8Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
}
