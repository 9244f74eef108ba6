// GPL-2.0-or-later. Leak lines, portals and light entities.
import * as THREE from 'three';
import { Spheres, SphereMode } from './spheres.js';

const kLeakRadius = 1.6;
const kLightRadius = 7;
const kMostLights = 8192;

/** A thick line through points, drawn over everything. */
export function leakLine(points) {
    const vectors = points.map((p) => new THREE.Vector3(...p));
    const material = new THREE.MeshBasicMaterial({
        color: 0xff4d4d,
        depthTest: false,
        transparent: true,
        opacity: 0.9,
    });
    const rods = new THREE.InstancedMesh(
        new THREE.CylinderGeometry(kLeakRadius, kLeakRadius, 1, 6, 1),
        material,
        vectors.length - 1,
    );
    const [up, matrix, turn] = [new THREE.Vector3(0, 1, 0), new THREE.Matrix4(), new THREE.Quaternion()];
    for (let i = 0; i + 1 < vectors.length; i++) {
        const along = vectors[i + 1].clone().sub(vectors[i]);
        const length = along.length();
        turn.setFromUnitVectors(up, length > 0 ? along.divideScalar(length) : up);
        matrix.compose(vectors[i].clone().lerp(vectors[i + 1], 0.5), turn, new THREE.Vector3(1, length, 1));
        rods.setMatrixAt(i, matrix);
    }
    rods.renderOrder = 4;
    rods.frustumCulled = false;
    return rods;
}

/** Triangles of a surface, tinted and drawn over everything. */
export function surfaceMark(triangles) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(triangles, 3));
    const mark = new THREE.Mesh(
        geometry,
        new THREE.MeshBasicMaterial({
            color: 0xf2c14e,
            transparent: true,
            opacity: 0.22,
            side: THREE.DoubleSide,
            depthTest: false,
        }),
    );
    mark.renderOrder = 3;
    mark.frustumCulled = false;
    return mark;
}

/** Portals as translucent polygons with edges; hint portals in another color. */
export function portalMesh(portals) {
    const [positions, colors, edges] = [[], [], []];
    for (const { points, hint } of portals) {
        for (let i = 1; i + 1 < points.length; i++)
            for (const corner of [points[0], points[i], points[i + 1]]) {
                positions.push(...corner);
                colors.push(...(hint ? [1, 0.75, 0.25] : [0.3, 0.75, 1]));
            }
        points.forEach((point, i) => edges.push(...point, ...points[(i + 1) % points.length]));
    }
    const faces = new THREE.BufferGeometry();
    faces.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    faces.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.Float32BufferAttribute(edges, 3));
    const group = new THREE.Group();
    group.add(
        new THREE.Mesh(
            faces,
            new THREE.MeshBasicMaterial({
                vertexColors: true,
                transparent: true,
                opacity: 0.16,
                side: THREE.DoubleSide,
                depthWrite: false,
            }),
        ),
    );
    group.add(
        new THREE.LineSegments(
            lines,
            new THREE.LineBasicMaterial({ color: 0x9bdcff, transparent: true, opacity: 0.75 }),
        ),
    );
    group.renderOrder = 3;
    return group;
}

/** Light entities as spheres in their color. */
export function lightSpheres(lights, lightUniforms) {
    const spheres = new Spheres(Math.min(lights.length, kMostLights), lightUniforms);
    for (const { origin, color } of lights) if (!spheres.full) spheres.add(...origin, kLightRadius, color, null);
    spheres.commit(SphereMode.tint);
    return spheres;
}

/** Frees what an object and those below it hold. */
export function disposeTree(object) {
    object.traverse((part) => {
        part.geometry?.dispose();
        part.material?.dispose();
    });
    object.removeFromParent();
}
