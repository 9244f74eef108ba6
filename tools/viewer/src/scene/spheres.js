// GPL-2.0-or-later. Spheres as camera-facing quads that are shaded as spheres: lit by coefficients, or in one color.
import * as THREE from 'three';
import { kDisplayGlsl, kGridLightGlsl } from './glsl.js';

const kShNames = Array.from({ length: 9 }, (_, k) => `sh${k}`);

const kVertexShader = `
in vec4 sphere; // center, radius
in vec3 tint;
${kShNames.map((name) => `in vec3 ${name};`).join('\n')}
out vec2 vCorner;
flat out vec3 vRight, vUp, vToEye, vTint;
${kShNames.map((name) => `flat out vec3 v_${name};`).join('\n')}

void main() {
    vec3 toEye = normalize(cameraPosition - sphere.xyz);
    vec3 right = normalize(cross(abs(toEye.z) > 0.999 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0), toEye));
    vec3 up = cross(toEye, right);
    vCorner = position.xy;
    vRight = right;
    vUp = up;
    vToEye = toEye;
    vTint = tint;
    ${kShNames.map((name) => `v_${name} = ${name};`).join('\n    ')}
    vec3 world = sphere.xyz + sphere.w * (position.x * right + position.y * up);
    gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

const kFragmentShader = `
uniform int mode; // 0: SH, 1: legacy light in sh0, sh1 and direction sh2, 2: tint
in vec2 vCorner;
flat in vec3 vRight, vUp, vToEye, vTint;
${kShNames.map((name) => `flat in vec3 v_${name};`).join('\n')}
out vec4 result;
${kDisplayGlsl}
${kGridLightGlsl}
void main() {
    float r2 = dot(vCorner, vCorner);
    if (r2 > 1.0) discard;
    vec3 n = vCorner.x * vRight + vCorner.y * vUp + sqrt(1.0 - r2) * vToEye;
    vec3 color;
    if (mode == 0)
        color = displayLight(shiftLight(applyTone(shLight(${kShNames.map((name) => `v_${name}`).join(', ')}, n))));
    else if (mode == 1)
        color = displayLight(legacyLight(v_sh0, v_sh1, v_sh2, n));
    else
        color = vTint * (0.62 + 0.38 * dot(n, normalize(vToEye + 0.6 * vUp - 0.3 * vRight)));
    result = vec4(color, 1.0);
}`;

export const SphereMode = { sh: 0, legacy: 1, tint: 2 };

export class Spheres {
    /**
     * @param {number} capacity the most spheres
     * @param {object} lightUniforms brightness, tone, tone2
     */
    constructor(capacity, lightUniforms) {
        this.capacity = capacity;
        this.geometry = new THREE.InstancedBufferGeometry();
        this.geometry.setAttribute(
            'position',
            new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3),
        );
        this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
        this.arrays = {};
        for (const [name, size] of [['sphere', 4], ['tint', 3], ...kShNames.map((sh) => [sh, 3])]) {
            const attribute = new THREE.InstancedBufferAttribute(new Float32Array(size * capacity), size);
            attribute.setUsage(THREE.DynamicDrawUsage);
            this.geometry.setAttribute(name, attribute);
            this.arrays[name] = attribute.array;
        }
        this.material = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader: kVertexShader,
            fragmentShader: kFragmentShader,
            uniforms: { ...lightUniforms, mode: { value: SphereMode.tint } },
        });
        this.mesh = new THREE.Mesh(this.geometry, this.material);
        this.mesh.frustumCulled = false;
        this.clear();
    }

    clear() {
        this.count = 0;
        this.geometry.instanceCount = 0;
    }

    get full() {
        return this.count >= this.capacity;
    }

    /** Adds a sphere; coeffs: 27 values of an SH grid, 9 of the legacy grid, or null. */
    add(x, y, z, radius, tint, coeffs) {
        const i = this.count++;
        this.arrays.sphere.set([x, y, z, radius], 4 * i);
        this.arrays.tint.set(tint, 3 * i);
        if (!coeffs) return;
        for (let k = 0; 3 * k < coeffs.length; k++)
            for (let c = 0; c < 3; c++) this.arrays[kShNames[k]][3 * i + c] = coeffs[3 * k + c];
    }

    /** Sends the spheres that were added to the graphics system. */
    commit(mode) {
        this.geometry.instanceCount = this.count;
        this.material.uniforms.mode.value = mode;
        for (const name of Object.keys(this.arrays)) {
            const attribute = this.geometry.attributes[name];
            attribute.clearUpdateRanges();
            attribute.addUpdateRange(0, this.count * attribute.itemSize);
            attribute.needsUpdate = true;
        }
    }
}
