// GPL-2.0-or-later. Images of a game: TGA by our reader, others by the browser.
import { decodeTga } from './tga.js';

const kEndings = ['tga', 'jpg', 'png', 'jpeg', 'webp'];
const kTypes = { jpg: 'image/jpeg', jpeg: 'image/jpeg', png: 'image/png', webp: 'image/webp' };

/** The file that an image without, or with another, ending is in; null if there is none. */
export function findImage(files, path) {
    if (files.has(path) && kEndings.some((ending) => path.endsWith(`.${ending}`))) return path;
    const base = path.replace(/\.(tga|jpe?g|png|webp)$/, '');
    return kEndings.map((ending) => `${base}.${ending}`).find((candidate) => files.has(candidate)) ?? null;
}

/**
 * @param {import('./game_files.js').GameFiles} files
 * @param {string} path from findImage
 * @returns an ImageBitmap, or for TGA {width, height, rgba}; first row on top
 * @throws if the image is damaged
 */
export async function readImage(files, path) {
    const bytes = await files.read(path);
    const ending = path.slice(path.lastIndexOf('.') + 1);
    if (ending === 'tga') return decodeTga(bytes, path);
    const blob = new Blob([bytes], { type: kTypes[ending] });
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
