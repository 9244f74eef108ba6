// GPL-2.0-or-later. Little endian bytes with checked ranges.

/** An error that the user can act on: the message says what is wrong with which file. */
export class FormatError extends Error {}

/** Latin-1 text of a range of bytes, up to the first NUL. */
export function textAt(bytes, offset, length) {
    let text = '';
    for (let i = offset; i < offset + length && bytes[i] !== 0; i++) text += String.fromCharCode(bytes[i]);
    return text;
}

/** A view on a range of bytes that may have any alignment. */
export function viewOf(bytes) {
    return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

/** A copy of little endian 32-bit integers. */
export function int32s(bytes) {
    const view = viewOf(bytes);
    return Int32Array.from({ length: bytes.byteLength >> 2 }, (_, i) => view.getInt32(4 * i, true));
}

/** A copy of little endian 32-bit floats. */
export function float32s(bytes) {
    const copy = bytes.slice();
    const floats = new Float32Array(copy.buffer, 0, copy.byteLength >> 2);
    if (new Uint8Array(new Uint16Array([1]).buffer)[0] === 1) return floats;
    const view = viewOf(copy);
    for (let i = 0; i < floats.length; i++) floats[i] = view.getFloat32(4 * i, true);
    return floats;
}

/** Throws a FormatError with the message unless the condition holds. */
export function expect(condition, message) {
    if (!condition) throw new FormatError(message);
}
