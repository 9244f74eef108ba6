// GPL-2.0-or-later. L2 spherical harmonics, and the tone of lightmaps. See docs/engines/quick_start.md and
// docs/engines/tone.md.

/** Nine basis functions at a unit normal, in map axes. */
export function shBasis(x, y, z) {
    return [
        0.282094791773878,
        0.48860251190292 * y,
        0.48860251190292 * z,
        0.48860251190292 * x,
        1.092548430592079 * x * y,
        1.092548430592079 * y * z,
        0.31539156525252 * (3 * z * z - 1),
        1.092548430592079 * x * z,
        0.54627421529604 * (x * x - y * y),
    ];
}

/** Light of 27 coefficients on a matte surface with that normal, 1 being lightmap byte 255; not below zero. */
export function shEvaluate(coeffs, normal) {
    const basis = shBasis(normal[0], normal[1], normal[2]);
    return [0, 1, 2].map((channel) => {
        let sum = 0;
        for (let k = 0; k < 9; k++) sum += coeffs[3 * k + channel] * basis[k];
        return sum > 0 ? sum : 0;
    });
}

/** Factors that turn a plain projection (-shradiance) into light on a matte surface, for each of 27 values. */
export const kConvolution = Float32Array.from({ length: 27 }, (_, i) =>
    i < 3 ? Math.PI : i < 12 ? (2 * Math.PI) / 3 : Math.PI / 4,
);

const kPlainTone = { contrast: 1, gamma: 1, exposure: 0, saturation: 1, scale: 1, maxlight: 255, srgb: 0 };

/**
 * Parses the worldspawn key _q3map2_tone, such as "gamma 1.4 scale 0.5"; unknown words are skipped with their number.
 * @returns the tone, and whether the text was valid; a plain tone if not, or without a text
 */
export function parseTone(text) {
    const words = (text ?? '')
        .trim()
        .split(/\s+/)
        .filter((word) => word !== '');
    const tone = { ...kPlainTone };
    let valid = words.length % 2 === 0;
    for (let i = 0; i + 1 < words.length; i += 2) {
        const value = Number(words[i + 1]);
        valid &&= Number.isFinite(value);
        if (Object.hasOwn(kPlainTone, words[i])) tone[words[i]] = value;
    }
    valid &&= tone.gamma > 0 && tone.scale > 0 && tone.maxlight >= 0 && tone.maxlight <= 255;
    return { valid, tone: valid ? tone : { ...kPlainTone } };
}
