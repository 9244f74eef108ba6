// GPL-2.0-or-later. Leak lines, portals, light entities, and rays to lights.
import * as THREE from 'three';
import { Spheres, SphereMode } from './spheres.js';

const kLeakRadius = 1.6;
const kRayRadius = 0.7;
const kPlaceRadius = 3;
const kMarkRadius = 5;
const kSunLength = 4096; // of rays to suns
const [kRed, kOrange] = [0xff4d4d, 0xf2c14e]; // as the screen shows them
const kLightRadius = 7;
const kMostLights = 8192;

/**
 * Thick lines, drawn over everything.
 * @param {THREE.Vector3[][]} segments pairs of ends
 */
function rods(segments, radius, color) {
    const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.9 });
    const mesh = new THREE.InstancedMesh(new THREE.CylinderGeometry(radius, radius, 1, 6, 1), material, segments.length);
    const [up, matrix, turn] = [new THREE.Vector3(0, 1, 0), new THREE.Matrix4(), new THREE.Quaternion()];
    segments.forEach(([from, to], i) => {
        const along = to.clone().sub(from);
        const length = along.length();
        turn.setFromUnitVectors(up, length > 0 ? along.divideScalar(length) : up);
        matrix.compose(from.clone().lerp(to, 0.5), turn, new THREE.Vector3(1, length, 1));
        mesh.setMatrixAt(i, matrix);
    });
    mesh.renderOrder = 4;
    mesh.frustumCulled = false;
    return mesh;
}

/** A line through points. */
export function leakLine(points) {
    const vectors = points.map((p) => new THREE.Vector3(...p));
    return rods(
        vectors.slice(1).map((to, i) => [vectors[i], to]),
        kLeakRadius,
        kRed,
    );
}

/**
 * The rays from an explained place to its strongest lights: orange to lights of which at least a part arrives, red up
 * to what is in the way.
 * @param {import('../bsp/side_files.js').Place} place
 */
export function lightRays(place) {
    const from = new THREE.Vector3(...place.at);
    const [lit, stopped] = [[], []];
    for (const { to, sun, visible, stops = [] } of place.rays) {
        const end = sun ? from.clone().addScaledVector(new THREE.Vector3(...to), kSunLength) : new THREE.Vector3(...to);
        if (visible > 0) lit.push([from, end]);
        for (const stop of stops) stopped.push([from, new THREE.Vector3(...stop)]);
    }
    const group = new THREE.Group();
    group.add(rods(lit, kRayRadius, kOrange), rods(stopped, kRayRadius, kRed), dots([place.at], kPlaceRadius, kOrange));
    group.add(dots(stopped.map(([, stop]) => stop.toArray()), kPlaceRadius, kRed));
    return group;
}

/** Small balls at points, drawn over everything. */
function dots(points, radius, color) {
    const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
    const mesh = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 12, 8), material, points.length);
    points.forEach((point, i) => mesh.setMatrixAt(i, new THREE.Matrix4().makeTranslation(...point)));
    mesh.renderOrder = 5;
    mesh.frustumCulled = false;
    return mesh;
}

/** Explained places, hidden by what is before them. */
export function placeDots(places) {
    const mesh = dots(
        places.map(({ at }) => at),
        kPlaceRadius,
        kOrange,
    );
    mesh.material.depthTest = true;
    return mesh;
}

/** A place that a message is about. */
export function placeMark(place) {
    return dots([place], kMarkRadius, kRed);
}

/** Triangles of a surface, tinted and drawn over everything. */
export function surfaceMark(triangles) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(triangles, 3));
    const mark = new THREE.Mesh(
        geometry,
        new THREE.MeshBasicMaterial({
            color: kOrange,
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
