// GPL-2.0-or-later. Truevision TGA images: true color, gray and palettes, plain or run-length encoded.
import { expect, viewOf } from '../bsp/bytes.js';

const kMostTexels = 8192 * 8192;

/** Reader of texels of 1 to 4 bytes as RGBA. */
function texelReader(bytes, head) {
    const alpha = head.bits === 32;
    const palette = (i) => colorAt(bytes, head.paletteAt + (i - head.paletteFirst) * head.paletteBytes, head.paletteBytes);
    return (at) => {
        if (head.kind === 1) return palette(bytes[at]);
        if (head.kind === 3) return [bytes[at], bytes[at], bytes[at], 255];
        const color = colorAt(bytes, at, head.bits >> 3);
        return alpha ? color : [color[0], color[1], color[2], 255];
    };
}

function colorAt(bytes, at, size) {
    if (size === 2) {
        const value = bytes[at] | (bytes[at + 1] << 8);
        const channel = (shift) => Math.round((((value >> shift) & 31) * 255) / 31);
        return [channel(10), channel(5), channel(0), 255];
    }
    return [bytes[at + 2], bytes[at + 1], bytes[at], size === 4 ? bytes[at + 3] : 255];
}

function readHead(bytes, name) {
    expect(bytes.length >= 18, `${name} ends in its header.`);
    const view = viewOf(bytes);
    const head = {
        packed: (bytes[2] & 8) !== 0, kind: bytes[2] & 7, width: view.getUint16(12, true), height: view.getUint16(14, true),
        bits: bytes[16], topDown: (bytes[17] & 32) !== 0, paletteFirst: view.getUint16(3, true),
        paletteAt: 18 + bytes[0], paletteBytes: bytes[7] >> 3,
    };
    head.dataAt = head.paletteAt + (bytes[1] ? view.getUint16(5, true) * head.paletteBytes : 0);
    const known = (head.kind === 1 && head.bits === 8 && head.paletteBytes >= 2) || (head.kind === 2 && [16, 24, 32].includes(head.bits)) ||
        (head.kind === 3 && head.bits === 8);
    expect(known, `${name} is a TGA image of a kind that this page does not read.`);
    expect(head.width > 0 && head.height > 0 && head.width * head.height <= kMostTexels, `${name} has no valid size.`);
    return head;
}

/**
 * @param {Uint8Array} bytes
 * @param {string} name shown in messages
 * @returns {{width: number, height: number, rgba: Uint8Array}} first row on top
 * @throws FormatError
 */
export function decodeTga(bytes, name) {
    const head = readHead(bytes, name);
    const { width, height } = head;
    const read = texelReader(bytes, head);
    const step = head.bits >> 3;
    const rgba = new Uint8Array(4 * width * height);
    const put = (i, color) => {
        const row = Math.floor(i / width);
        rgba.set(color, 4 * ((head.topDown ? row : height - 1 - row) * width + (i % width)));
    };
    let at = head.dataAt;
    for (let i = 0; i < width * height; ) {
        const control = head.packed ? bytes[at++] : 127;
        const count = Math.min((control & 127) + 1, width * height - i);
        const repeats = control > 127;
        expect(at + (repeats ? step : step * count) <= bytes.length, `${name} is cut off.`);
        for (let k = 0; k < count; k++) put(i++, read(at + (repeats ? 0 : step * k)));
        at += repeats ? step : step * count;
    }
    return { width, height, rgba };
}
