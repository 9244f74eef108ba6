// GPL-2.0-or-later. Truevision TGA images: true color, gray and palettes, plain or run-length encoded.
import { expect, viewOf } from '../bsp/bytes.js';

const kMostTexels = 8192 * 8192;

/** Writes a color of 2 to 4 bytes as RGBA. */
function putColor(bytes, at, size, rgba, to) {
    if (size === 2) {
        const value = bytes[at] | (bytes[at + 1] << 8);
        for (let k = 0; k < 3; k++) rgba[to + k] = Math.round((((value >> (10 - 5 * k)) & 31) * 255) / 31);
        rgba[to + 3] = 255;
        return;
    }
    rgba[to] = bytes[at + 2];
    rgba[to + 1] = bytes[at + 1];
    rgba[to + 2] = bytes[at];
    rgba[to + 3] = size === 4 ? bytes[at + 3] : 255;
}

/** A function that writes the texel at an offset as RGBA. */
function texelWriter(bytes, head, rgba) {
    if (head.kind === 1)
        return (at, to) =>
            putColor(
                bytes,
                head.paletteAt + (bytes[at] - head.paletteFirst) * head.paletteBytes,
                head.paletteBytes,
                rgba,
                to,
            );
    if (head.kind === 3)
        return (at, to) => {
            rgba.fill(bytes[at], to, to + 3);
            rgba[to + 3] = 255;
        };
    return (at, to) => putColor(bytes, at, head.bits >> 3, rgba, to);
}

function readHead(bytes, name) {
    expect(bytes.length >= 18, `${name} ends in its header.`);
    const view = viewOf(bytes);
    const head = {
        packed: (bytes[2] & 8) !== 0,
        kind: bytes[2] & 7,
        width: view.getUint16(12, true),
        height: view.getUint16(14, true),
        bits: bytes[16],
        topDown: (bytes[17] & 32) !== 0,
        paletteFirst: view.getUint16(3, true),
        paletteAt: 18 + bytes[0],
        paletteBytes: bytes[7] >> 3,
    };
    head.dataAt = head.paletteAt + (bytes[1] ? view.getUint16(5, true) * head.paletteBytes : 0);
    const known =
        (head.kind === 1 && head.bits === 8 && head.paletteBytes >= 2) ||
        (head.kind === 2 && [16, 24, 32].includes(head.bits)) ||
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
    const step = head.bits >> 3;
    const rgba = new Uint8Array(4 * width * height);
    const write = texelWriter(bytes, head, rgba);
    const target = (i) => 4 * (head.topDown ? i : (height - 1 - Math.floor(i / width)) * width + (i % width));
    let at = head.dataAt;
    for (let i = 0; i < width * height;) {
        const control = head.packed ? bytes[at++] : 127;
        const count = Math.min((control & 127) + 1, width * height - i);
        const repeats = control > 127;
        expect(at + (repeats ? step : step * count) <= bytes.length, `${name} is cut off.`);
        for (let k = 0; k < count; k++) write(at + (repeats ? 0 : step * k), target(i++));
        at += repeats ? step : step * count;
    }
    return { width, height, rgba };
}
