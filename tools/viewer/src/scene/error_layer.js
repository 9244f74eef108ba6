// GPL-2.0-or-later. Errors of a grid at positions in a horizontal slice, as dots in the colors of a scale.
import * as THREE from 'three';

/** Colors of the scale from no error to the largest, evenly apart. */
export const kScale = ['#2b2f77', '#2f6fb3', '#2fa8a0', '#7ccb63', '#f3e35a', '#f59b3d', '#e0403a'];

const kVertexShader = `
in float error;
uniform float largest, height, thickness, size, viewHeight;
out float vShare;
void main() {
    vShare = clamp(error / largest, 0.0, 1.0);
    vec4 eye = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * eye;
    gl_PointSize = clamp(size * viewHeight * projectionMatrix[1][1] / gl_Position.w, 3.0, 64.0);
    if (abs(position.z - height) > 0.5 * thickness) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const kFragmentShader = `
uniform vec3 scale[${kScale.length}];
in float vShare;
out vec4 result;
void main() {
    float r = length(gl_PointCoord - 0.5) * 2.0;
    if (r > 1.0) discard;
    float at = vShare * ${(kScale.length - 1).toFixed(1)};
    int i = min(int(at), ${kScale.length - 2});
    vec3 color = mix(scale[i], scale[i + 1], at - float(i));
    result = vec4(color * (r > 0.8 ? 0.55 : 1.0), 1.0);
}`;

/** A round number at or a little above the value: 1, 2, 3, 5 or 8 times a power of ten. */
function roundUp(value) {
    const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-3)));
    return ([1, 2, 3, 5, 8].find((n) => n * power >= value) ?? 10) * power;
}

export class ErrorLayer {
    /** From parseErrors; null: none. */
    errors = null;

    constructor() {
        const color = (hex) => new THREE.Color().setStyle(hex, THREE.LinearSRGBColorSpace);
        this.uniforms = {
            scale: { value: kScale.map(color) },
            largest: { value: 1 },
            height: { value: 0 },
            thickness: { value: 64 },
            size: { value: 3 },
            viewHeight: { value: 600 },
        };
        const material = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader: kVertexShader,
            fragmentShader: kFragmentShader,
            uniforms: this.uniforms,
        });
        this.points = new THREE.Points(new THREE.BufferGeometry(), material);
        this.points.frustumCulled = false;
        this.points.visible = false;
    }

    /** @param errors from parseErrors; null: none */
    set(errors) {
        this.errors = errors;
        this.points.geometry.dispose();
        this.points.geometry = new THREE.BufferGeometry();
        if (!errors) return;
        this.points.geometry.setAttribute('position', new THREE.BufferAttribute(errors.positions, 3));
        this.sh = new THREE.BufferAttribute(errors.sh, 1);
        this.legacy = errors.legacy && new THREE.BufferAttribute(errors.legacy, 1);
        const sorted = Float32Array.from([...errors.sh, ...(errors.legacy ?? [])]).sort();
        this.suggestedLargest = roundUp(sorted[Math.floor(0.95 * (sorted.length - 1))] || 1);
    }

    /**
     * @param {'off'|'sh'|'legacy'} show
     * @returns number of the positions in the slice and root mean square of their errors; null if nothing is shown
     */
    update(show, { height, thickness, largest, viewHeight }) {
        this.points.visible = this.errors !== null && show !== 'off';
        if (!this.points.visible) return null;
        this.points.geometry.setAttribute('error', show === 'sh' ? this.sh : this.legacy);
        for (const [name, value] of Object.entries({ height, thickness, largest, viewHeight }))
            this.uniforms[name].value = value;
        return this.summary(this.errors[show], height, thickness);
    }

    summary(values, height, thickness) {
        let [count, sum] = [0, 0];
        const { positions } = this.errors;
        for (let i = 0; i < values.length; i++)
            if (Math.abs(positions[3 * i + 2] - height) <= thickness / 2) {
                count++;
                sum += values[i] * values[i];
            }
        return { count, rms: count > 0 ? Math.sqrt(sum / count) : 0 };
    }
}
