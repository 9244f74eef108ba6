// GPL-2.0-or-later. Pieces of shaders that several layers share.

/** Bits of brightness that the game adds on display, r_overBrightBits. */
export const kOverBrightBits = 1;

/** Bits that light of the map is shifted by on loading: r_mapOverBrightBits less r_overBrightBits. */
export const kMapShift = 2 - kOverBrightBits;

/** From light of the map (1 is byte 255, not yet shifted) to the screen, and of light that has been shifted. */
export const kDisplayGlsl = `
uniform float brightness;

float largest(vec3 v) { return max(v.r, max(v.g, v.b)); }

vec3 shiftLight(vec3 light) { // as on loading: too bright colors keep their hue
    light *= ${(1 << kMapShift).toFixed(1)};
    return light / max(1.0, largest(light));
}

vec3 displayLight(vec3 shifted) {
    return min(shifted * ${(1 << kOverBrightBits).toFixed(1)} * brightness, 1.0);
}
`;

/** Light of nine coefficients, the tone of lightmaps, and light of the legacy grid. */
export const kGridLightGlsl = `
uniform vec4 tone;  // contrast, 1 / gamma, exposure, saturation
uniform vec3 tone2; // scale, maxlight / 255, srgb

vec3 applyTone(vec3 light) {
    vec3 v = max(tone.x * (light - 128.0 / 255.0) + 128.0 / 255.0, 0.0);
    v = pow(v, vec3(tone.y));
    float m = largest(v);
    if (tone.z != 0.0 && m > 0.0) v *= (1.0 - exp(-255.0 * m / tone.z)) / m;
    vec3 gray = vec3(dot(v, vec3(0.3086, 0.6094, 0.0820)));
    v = max(mix(gray, v, tone.w), 0.0) * tone2.x;
    m = largest(v);
    if (m > tone2.y) v *= tone2.y / m;
    if (tone2.z != 0.0) v = mix(12.92 * v, 1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), v));
    return v;
}

vec3 shLight(vec3 c0, vec3 c1, vec3 c2, vec3 c3, vec3 c4, vec3 c5, vec3 c6, vec3 c7, vec3 c8, vec3 n) {
    vec3 light = c0 * 0.282094792 + (c1 * n.y + c2 * n.z + c3 * n.x) * 0.488602512
        + (c4 * (n.x * n.y) + c5 * (n.y * n.z) + c7 * (n.x * n.z)) * 1.092548431
        + c6 * (0.315391565 * (3.0 * n.z * n.z - 1.0)) + c8 * (0.546274215 * (n.x * n.x - n.y * n.y));
    return max(light, 0.0);
}

vec3 legacyLight(vec3 ambient, vec3 directed, vec3 direction, vec3 n) { // of light that has been shifted
    return min(ambient + directed * max(dot(direction, n), 0.0), 1.0);
}
`;
