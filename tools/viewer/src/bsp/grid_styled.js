// GPL-2.0-or-later. The legacy light grid of RBSP and FBSP: records of four light styles, and an array of their numbers.
import { expect, viewOf } from './bytes.js';
import { LegacyLattice, directionOf } from './grid_legacy.js';
import { kSlots } from './map.js';

const kRecordBytes = 30;
const kDirected = 3 * kSlots; // bytes from the start of a record
const kStyles = 6 * kSlots;
const kAngles = 7 * kSlots;
const kFreeStyle = 255;

/** Brightness of each light style, 0 to 1: at first style 0 alone shines. */
export function onlyStyle0() {
    const styleLight = new Float32Array(256);
    styleLight[0] = 1;
    return styleLight;
}

export class StyledGrid extends LegacyLattice {
    /** Brightness by style; may be changed. */
    styleLight = onlyStyle0();
    /** Points that name a record which does not exist. They are black. */
    outside = 0;

    /**
     * @param {Uint8Array} records
     * @param {Uint8Array} array for each point the number of its record
     * @param {{mins: number[], maxs: number[]}} world model 0
     * @param {Map<string, string>} worldspawn
     * @throws FormatError if the array has another length than the world needs
     */
    constructor(records, array, world, worldspawn) {
        super(array.length / 2, world, worldspawn);
        expect(records.length % kRecordBytes === 0, 'The legacy light grid does not hold whole records.');
        const count = records.length / kRecordBytes;
        const view = viewOf(array);
        const numberOf = (i) => Math.min(view.getUint16(2 * i, true), count);
        // The record behind the last one is black and has no style.
        this.bytes = new Uint8Array(records.length + kRecordBytes);
        this.bytes.set(records);
        this.bytes.fill(kFreeStyle, records.length + kStyles, records.length + kAngles);
        this.numbers = Uint32Array.from({ length: this.count }, (_, i) => numberOf(i));
        this.outside = this.numbers.reduce((sum, number) => sum + (number === count ? 1 : 0), 0);
        const styles = new Set();
        for (let i = 0; i < count; i++) for (const style of this.stylesAt(kRecordBytes * i)) styles.add(style);
        styles.delete(0);
        this.styles = [...styles];
    }

    /** Styles of the used slots of the record at an offset. */
    stylesAt(at) {
        const styles = [...this.bytes.subarray(at + kStyles, at + kAngles)];
        const free = styles.indexOf(kFreeStyle);
        return free < 0 ? styles : styles.slice(0, free);
    }

    /** OpenJK leaves out points without a style. */
    isInWall(i) {
        return this.bytes[kRecordBytes * this.numbers[i] + kStyles] === kFreeStyle;
    }

    /** Ambient and directed light of all styles in bytes, direction to the light. */
    point(i) {
        const at = kRecordBytes * this.numbers[i];
        // A point in a wall may have light for engines that do not leave it out.
        const shares = this.isInWall(i) ? [1] : this.stylesAt(at).map((style) => this.styleLight[style]);
        const sum = (from) =>
            [0, 1, 2].map((c) => shares.reduce((all, share, slot) => all + share * this.bytes[from + 3 * slot + c], 0));
        return {
            ambient: sum(at),
            directed: sum(at + kDirected),
            direction: directionOf(this.bytes[at + kAngles], this.bytes[at + kAngles + 1]),
        };
    }
}
