// GPL-2.0-or-later. A movable figure that is lit by the grids at its light origin, as moving things are in the game.
import * as THREE from 'three';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';
import { modelLight } from '../bsp/grid_legacy.js';
import { kDisplayGlsl, kGridLightGlsl, kMapShift, kOverBrightBits } from './glsl.js';

const kFeet = -24; // below the light origin, as with players
const kApart = 22; // units from the middle, where two figures stand side by side
const kMinLight = 32 >> kOverBrightBits; // bytes; what the game adds to everything that moves

const kVertexShader = `
out vec3 vNormal;
void main() {
    vNormal = mat3(modelMatrix) * normal;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const kFragmentShader = `
uniform bool legacy;
uniform vec3 sh[9];
uniform vec3 ambient, directed, direction;
uniform float minLight; // added to light of the SH grid
in vec3 vNormal;
out vec4 result;
${kDisplayGlsl}
${kGridLightGlsl}
void main() {
    vec3 n = normalize(vNormal);
    vec3 light = legacy ? legacyLight(ambient, directed, direction, n)
        : shiftLight(applyTone(shLight(sh[0], sh[1], sh[2], sh[3], sh[4], sh[5], sh[6], sh[7], sh[8], n)));
    if (!legacy) light = min(light + minLight, 1.0);
    result = vec4(displayLight(light), 1.0);
}`;

/** A smooth figure of 56 units, feet at kFeet. */
function figureGeometry() {
    const limb = (radius, length, x, z) =>
        new THREE.CapsuleGeometry(radius, length, 6, 16).rotateX(Math.PI / 2).translate(x, 0, z);
    const profile = [
        [0, 0],
        [5, 0.6],
        [7, 4],
        [6.4, 9],
        [6, 13],
        [7.6, 19],
        [8.4, 23],
        [7, 26.5],
        [3, 28.5],
        [0, 29],
    ];
    const body = new THREE.LatheGeometry(
        new THREE.SplineCurve(profile.map(([r, h]) => new THREE.Vector2(r, h))).getPoints(24),
        28,
    );
    body.rotateX(Math.PI / 2)
        .scale(1, 0.72, 1)
        .translate(0, 0, kFeet + 21);
    const head = new THREE.SphereGeometry(5.2, 28, 20).scale(0.92, 1, 1.12).translate(0, 0, kFeet + 55);
    const parts = [
        body,
        head,
        new THREE.CapsuleGeometry(2.2, 3, 4, 14).rotateX(Math.PI / 2).translate(0, 0, kFeet + 50),
        limb(3.2, 17, -4, kFeet + 11.5),
        limb(3.2, 17, 4, kFeet + 11.5),
        limb(2.5, 18, -9.8, kFeet + 36.5),
        limb(2.5, 18, 9.8, kFeet + 36.5),
    ];
    for (const part of parts) part.deleteAttribute('uv');
    const joined = mergeGeometries(parts);
    joined.computeVertexNormals();
    return joined;
}

export class Figure {
    group = new THREE.Group();
    /** Position of the light origin, where the grids are sampled. */
    origin = new THREE.Vector3();

    constructor(lightUniforms) {
        const geometry = figureGeometry();
        this.shared = {
            ...lightUniforms,
            minLight: { value: 0 },
            sh: { value: Array.from({ length: 9 }, () => new THREE.Vector3()) },
            ambient: { value: new THREE.Vector3() },
            directed: { value: new THREE.Vector3() },
            direction: { value: new THREE.Vector3() },
        };
        this.sh = this.addMesh(geometry, false);
        this.legacy = this.addMesh(geometry, true);
        const mark = new THREE.MeshBasicMaterial({
            color: 0xffd166,
            depthTest: false,
            transparent: true,
            opacity: 0.9,
        });
        this.mark = new THREE.Mesh(new THREE.OctahedronGeometry(1.3), mark);
        this.mark.renderOrder = 5;
        this.group.add(this.mark);
        this.group.visible = false;
    }

    addMesh(geometry, legacy) {
        const mesh = new THREE.Mesh(
            geometry,
            new THREE.ShaderMaterial({
                glslVersion: THREE.GLSL3,
                vertexShader: kVertexShader,
                fragmentShader: kFragmentShader,
                uniforms: { ...this.shared, legacy: { value: legacy } },
            }),
        );
        this.group.add(mesh);
        return mesh;
    }

    /**
     * Lights and places the figure.
     * @param {'off'|'sh'|'legacy'|'both'} show
     * @param {number} yaw radians that it faces
     * @returns the light at its origin as the grids have it, for the panel
     */
    update(show, yaw, grids, source, minLight) {
        const position = this.origin.toArray();
        this.group.visible = show !== 'off';
        this.group.position.copy(this.origin);
        this.group.rotation.set(0, 0, yaw - Math.PI / 2);
        this.sh.visible = show === 'sh' || show === 'both';
        this.legacy.visible = show === 'legacy' || show === 'both';
        const apart = show === 'both' ? kApart : 0;
        this.sh.position.x = apart; // it faces the viewer, so this is on the left
        this.legacy.position.x = -apart;
        const coeffs = source?.sample(position) ?? new Float32Array(27);
        this.shared.sh.value.forEach((vector, k) => vector.fromArray(coeffs, 3 * k));
        const light = grids.legacy?.sample(position, kMapShift) ?? {
            ambient: [0, 0, 0],
            directed: [0, 0, 0],
            direction: [0, 0, 0],
        };
        const minimum = minLight ? kMinLight : 0;
        this.shared.ambient.value.fromArray(modelLight(light, minimum).ambient).divideScalar(255);
        this.shared.directed.value.fromArray(light.directed).divideScalar(255);
        this.shared.direction.value.fromArray(light.direction);
        this.shared.minLight.value = minimum / 255;
        return { coeffs, legacy: light };
    }

    /** Whether a ray hits one of the figures. */
    isHit(raycaster) {
        return (
            this.group.visible &&
            raycaster.intersectObjects([this.sh, this.legacy].filter((mesh) => mesh.visible)).length > 0
        );
    }
}
