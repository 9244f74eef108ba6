// GPL-2.0-or-later. Values at positions as dots in the colors of a scale: discs on surfaces, or facing the viewer.
import * as THREE from 'three';

const kLift = 0.5; // units that a disc lies before its surface

const kVertexShader = `
in vec3 center; // of the dot; its normal is zero if it faces the viewer
in float value;
uniform float least, largest, low, high, radius, viewHeight;
out float vShare;
out vec2 vCorner;
void main() {
    vShare = clamp((value - least) / (largest - least), 0.0, 1.0);
    vCorner = position.xy;
    vec3 toEye = cameraPosition - center;
    bool isOnSurface = dot(normal, normal) > 0.0;
    vec3 n = isOnSurface ? normal : normalize(toEye);
    vec3 right = normalize(cross(abs(n.z) > 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0), n));
    float pixel = 2.0 * (viewMatrix * vec4(center, 1.0)).z / (-viewHeight * projectionMatrix[1][1]);
    float drawn = max(isOnSurface ? radius : min(radius, 32.0 * pixel), 1.5 * pixel);
    vec3 world = center + drawn * (position.x * right + position.y * cross(n, right));
    if (isOnSurface) world += ${kLift} * n;
    gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
    if (center.z < low || center.z > high || dot(n, toEye) <= 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const fragmentShader = (colors) => `
uniform vec4 scale[${colors}];
in float vShare;
in vec2 vCorner;
out vec4 result;
void main() {
    float r = length(vCorner);
    if (r > 1.0) discard;
    float at = vShare * ${(colors - 1).toFixed(1)};
    int i = min(int(at), ${colors - 2});
    vec4 color = mix(scale[i], scale[i + 1], at - float(i));
    result = vec4(color.rgb * (r > 0.8 ? mix(1.0, 0.55, color.a) : 1.0), color.a);
}`;

/** A color "#rrggbb" or "#rrggbbaa", 0 to 1. */
function colorOf(hex) {
    return new THREE.Vector4(...[1, 3, 5, 7].map((i) => parseInt(hex.slice(i, i + 2) || 'ff', 16) / 255));
}

/** A round number at or a little above the value: 1, 2, 3, 5 or 8 times a power of ten. */
function roundUp(value) {
    const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-3)));
    return ([1, 2, 3, 5, 8].find((n) => n * power >= value) ?? 10) * power;
}

/** A round end of the scale, at least 1, that at most a twentieth of the values exceeds. */
function endOfScale(values) {
    const sorted = Float32Array.from(values, Math.abs).sort();
    return Math.max(roundUp(sorted[Math.floor(0.95 * (sorted.length - 1))] ?? 0), 1);
}

export class DotsLayer {
    /** The end of the scale for the values at hand. */
    suggestedLargest = 1;

    /** @param {string[]} scale colors evenly apart, "#rrggbb", or "#rrggbbaa" for dots that the map shows through */
    constructor(scale) {
        const isClear = scale.some((hex) => hex.length > 7);
        this.uniforms = { scale: { value: scale.map(colorOf) } };
        for (const name of ['least', 'largest', 'low', 'high', 'radius', 'viewHeight'])
            this.uniforms[name] = { value: 1 };
        const material = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader: kVertexShader,
            fragmentShader: fragmentShader(scale.length),
            uniforms: this.uniforms,
            side: THREE.DoubleSide,
            transparent: isClear,
            depthWrite: !isClear, // dots that overlap on a surface would hide parts of each other
            polygonOffset: true,
            polygonOffsetFactor: -1,
            polygonOffsetUnits: -4,
        });
        this.mesh = new THREE.Mesh(new THREE.InstancedBufferGeometry(), material);
        this.mesh.frustumCulled = false;
        this.mesh.renderOrder = isClear ? 2 : 0; // after glass and water
        this.mesh.visible = false;
        const size = new THREE.Vector2();
        this.mesh.onBeforeRender = (renderer) => {
            this.uniforms.viewHeight.value = renderer.getDrawingBufferSize(size).y;
            material.uniformsNeedUpdate = true;
        };
    }

    /**
     * @param {Float32Array} positions three numbers each; none: no dots
     * @param {Float32Array[]} values sets of values that can be shown, a number for each position
     * @param {{radius: number, normals?: Float32Array}} options radius of a dot in units; normals of the surfaces that
     *     dots lie on, zero if a dot faces the viewer, as all do without normals
     */
    set(positions, values, { radius, normals = new Float32Array(positions.length) }) {
        this.mesh.geometry.dispose();
        const geometry = new THREE.InstancedBufferGeometry();
        const corners = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]);
        geometry.setAttribute('position', new THREE.BufferAttribute(corners, 3));
        geometry.setIndex([0, 1, 2, 0, 2, 3]);
        geometry.setAttribute('center', new THREE.InstancedBufferAttribute(positions, 3));
        geometry.setAttribute('normal', new THREE.InstancedBufferAttribute(normals, 3));
        geometry.instanceCount = positions.length / 3;
        this.mesh.geometry = geometry;
        this.positions = positions;
        this.values = new Map(values.map((set) => [set, new THREE.InstancedBufferAttribute(set, 1)]));
        this.suggestedLargest = endOfScale(values.flatMap((set) => [...set]));
        this.uniforms.radius.value = radius;
    }

    /**
     * @param {Float32Array|null} values one of the sets; null: no dots
     * @param {{least: number, largest: number, low: number, high: number}} options ends of the scale, and of the
     *     heights in which there are dots
     * @returns number of the dots and root mean square of their values; null if nothing is shown
     */
    show(values, options) {
        this.mesh.visible = values !== null;
        if (!values) return null;
        this.mesh.geometry.setAttribute('value', this.values.get(values));
        for (const [name, value] of Object.entries(options)) this.uniforms[name].value = value;
        let [count, sum] = [0, 0];
        for (let i = 0; i < values.length; i++)
            if (this.positions[3 * i + 2] >= options.low && this.positions[3 * i + 2] <= options.high) {
                count++;
                sum += values[i] * values[i];
            }
        return { count, rms: count > 0 ? Math.sqrt(sum / count) : 0 };
    }
}
