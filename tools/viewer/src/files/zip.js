// GPL-2.0-or-later. Archives (.pk3) read in parts: only the directory and the entries that are asked for.
import { inflateSync } from 'fflate';
import { expect, viewOf } from '../bsp/bytes.js';

const kEndBytes = 22;
const kMostComment = 65535;
const kMostEntryBytes = 512 << 20;

async function bytesOf(blob, start, end) {
    return new Uint8Array(await blob.slice(start, end).arrayBuffer());
}

/** Offset and size of the directory, from the record at the end of the archive. */
async function findDirectory(blob) {
    const tail = await bytesOf(blob, Math.max(0, blob.size - kEndBytes - kMostComment), blob.size);
    const view = viewOf(tail);
    for (let at = tail.length - kEndBytes; at >= 0; at--)
        if (view.getUint32(at, true) === 0x06054b50)
            return {
                count: view.getUint16(at + 10, true),
                size: view.getUint32(at + 12, true),
                offset: view.getUint32(at + 16, true),
            };
    return null;
}

/** Paths are UTF-8, or Latin-1 in archives of old tools. */
function decodePath(bytes) {
    try {
        return new TextDecoder('utf-8', { fatal: true }).decode(bytes);
    } catch {
        return new TextDecoder('latin1').decode(bytes);
    }
}

export class Archive {
    /** Entries by lower-case path: method, sizes, offset. */
    entries = new Map();

    constructor(blob, name) {
        this.blob = blob;
        this.name = name;
    }

    /**
     * @param {Blob} blob
     * @param {string} name shown in messages
     * @throws FormatError if it is no zip archive
     */
    static async open(blob, name) {
        const archive = new Archive(blob, name);
        const end = await findDirectory(blob);
        expect(end && end.offset + end.size <= blob.size, `${name} is not a pk3 (zip) archive, or it is cut off.`);
        archive.readDirectory(await bytesOf(blob, end.offset, end.offset + end.size), end.count);
        return archive;
    }

    readDirectory(bytes, count) {
        const view = viewOf(bytes);
        for (let i = 0, at = 0; i < count; i++) {
            expect(
                at + 46 <= bytes.length && view.getUint32(at, true) === 0x02014b50,
                `The directory of ${this.name} is damaged.`,
            );
            const nameLength = view.getUint16(at + 28, true);
            const path = decodePath(bytes.subarray(at + 46, at + 46 + nameLength))
                .replaceAll('\\', '/')
                .toLowerCase();
            this.entries.set(path, {
                method: view.getUint16(at + 10, true),
                packed: view.getUint32(at + 20, true),
                size: view.getUint32(at + 24, true),
                offset: view.getUint32(at + 42, true),
            });
            at += 46 + nameLength + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
        }
    }

    /**
     * @param {string} path lower case
     * @throws FormatError if the entry is damaged
     */
    async read(path) {
        const entry = this.entries.get(path);
        const damaged = `${path} in ${this.name} is damaged.`;
        const head = await bytesOf(this.blob, entry.offset, entry.offset + 30);
        expect(head.length === 30 && entry.size <= kMostEntryBytes, damaged);
        const view = viewOf(head);
        const start = entry.offset + 30 + view.getUint16(26, true) + view.getUint16(28, true);
        const packed = await bytesOf(this.blob, start, start + entry.packed);
        expect(packed.length === entry.packed && (entry.method === 0 || entry.method === 8), damaged);
        if (entry.method === 0) return packed;
        try {
            return inflateSync(packed, { out: new Uint8Array(entry.size) });
        } catch {
            return expect(false, damaged);
        }
    }
}
