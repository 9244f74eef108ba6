// GPL-2.0-or-later. Surfaces of a map in few meshes: one for each texture and way of drawing.
import * as THREE from 'three';
import { SurfaceFlag, SurfaceType, kSlots, colorField, lightmapField } from '../bsp/map.js';
import { parseVector } from '../bsp/entities.js';
import { fieldsOf, tessellate } from '../bsp/patch.js';
import { shiftColor } from '../bsp/grid_legacy.js';
import { kDisplayGlsl, kMapShift } from './glsl.js';

/** Luxel sizes with a color of their own, units, and the colors; sizes between have a color between. */
export const kLuxelSizes = [2, 8, 16, 32, 64];
export const kLuxelColors = ['#b06bff', '#4f8dff', '#39c46a', '#f2c14e', '#ff5a4f'];

const kVertexLight = -1;
const kNoLight = -2;

const kVertexShader = `
in vec2 st;
in vec3 lightmap; // texture coordinates and layer, or one of the values below 0
in vec4 color;
#ifdef STYLED // light of up to four styles in slots, added up
in vec3 lightmap1, lightmap2, lightmap3;
in vec4 color1, color2, color3; // black in free slots
in vec4 styles;
uniform sampler2D styleLight; // brightness by style
out vec2 vLightmap1, vLightmap2, vLightmap3;
flat out vec3 vLayers; // of slots 1 to 3
flat out vec4 vShares;
#endif
in vec3 clusterColor;
in vec3 luxelColor;
out vec2 vSt;
out vec2 vLightmap;
flat out float vLayer;
out vec4 vColor;
out vec3 vClusterColor;
out vec3 vLuxelColor;
out float vHeight;

void main() {
    vSt = st;
    vLightmap = lightmap.xy;
    vLayer = lightmap.z;
    vColor = color;
    vClusterColor = clusterColor;
    vLuxelColor = luxelColor;
    vHeight = position.z;
#ifdef STYLED
    vLightmap1 = lightmap1.xy;
    vLightmap2 = lightmap2.xy;
    vLightmap3 = lightmap3.xy;
    vLayers = vec3(lightmap1.z, lightmap2.z, lightmap3.z);
    for (int i = 0; i < 4; i++) vShares[i] = texelFetch(styleLight, ivec2(int(styles[i]), 0), 0).r;
    vColor.rgb = min(mat4x3(color.rgb, color1.rgb, color2.rgb, color3.rgb) * vShares, 1.0);
#endif
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const kFragmentShader = `
precision highp sampler2DArray;
uniform sampler2D image;
uniform sampler2DArray lightmaps;
uniform float textured;
uniform float tint; // 0: none, 1: clusters, 2: luxels
uniform float alphaTest;
uniform float cutHeight;
uniform vec3 plainColor; // of skies; below 0: none
in vec2 vSt;
in vec2 vLightmap;
flat in float vLayer;
in vec4 vColor;
in vec3 vClusterColor;
in vec3 vLuxelColor;
in float vHeight;
#ifdef STYLED
in vec2 vLightmap1, vLightmap2, vLightmap3;
flat in vec3 vLayers;
flat in vec4 vShares;
#endif
out vec4 result;
${kDisplayGlsl}
vec3 lightmapLight(vec2 at, float layer) {
    return texture(lightmaps, vec3(at, layer)).rgb;
}

vec3 mapLight() {
    if (vLayer < ${(kNoLight + 0.5).toFixed(1)}) return vec3(0.5);
    if (vLayer < 0.0) return vColor.rgb;
    vec3 light = lightmapLight(vLightmap, vLayer);
#ifdef STYLED
    light *= vShares.x;
    if (vLayers.x >= 0.0) light += vShares.y * lightmapLight(vLightmap1, vLayers.x);
    if (vLayers.y >= 0.0) light += vShares.z * lightmapLight(vLightmap2, vLayers.y);
    if (vLayers.z >= 0.0) light += vShares.w * lightmapLight(vLightmap3, vLayers.z);
#endif
    return light;
}

void main() {
#ifdef CUT // without it, hidden texels are rejected before they are shaded
    if (vHeight > cutHeight) discard;
#endif
    if (plainColor.r >= 0.0) {
        result = vec4(plainColor, 1.0);
        return;
    }
    vec4 texel = texture(image, vSt);
#ifdef ALPHA_TEST
    if (alphaTest > 0.0 ? texel.a < alphaTest : alphaTest < 0.0 && texel.a >= -alphaTest) discard;
#endif
    if (textured == 0.0) texel.rgb = vec3(1.0);
    vec3 light = mapLight();
    if (tint > 0.0) {
        texel = vec4(tint > 1.0 ? vLuxelColor : vClusterColor, 1.0);
        light = vec3(0.2) + 0.3 * sqrt(light);
        if (tint > 1.0 && vLayer >= 0.0) { // a board of luxels, which fades where they are smaller than pixels
            vec2 luxel = vLightmap * vec2(textureSize(lightmaps, 0).xy);
            float pixels = 1.0 / max(max(fwidth(luxel.x), fwidth(luxel.y)), 1e-6);
            float odd = mod(floor(luxel.x) + floor(luxel.y), 2.0);
            light *= 1.0 + clamp(pixels - 1.5, 0.0, 1.0) * (0.35 * odd - 0.175);
        }
    }
    result = vec4(texel.rgb * displayLight(light), texel.a);
}`;

const kBlending = {
    add: { blending: THREE.AdditiveBlending },
    blend: { blending: THREE.NormalBlending },
    filter: { blending: THREE.MultiplyBlending, premultipliedAlpha: true },
};

/** A color that differs well from those of neighboring numbers. */
function clusterColor(cluster) {
    if (cluster < 0) return [0.45, 0.45, 0.45];
    const hue = (cluster * 0.61803398875) % 1;
    const color = new THREE.Color().setHSL(hue, 0.4, 0.52 + 0.16 * (((cluster * 7) % 3) - 1));
    return [color.r, color.g, color.b];
}

const kTableColors = kLuxelColors.map((color) => new THREE.Color().setStyle(color, THREE.LinearSRGBColorSpace));

/** The color of a luxel size in units; gray without a lightmap. */
function luxelColor(size) {
    if (!(size > 0)) return [0.45, 0.45, 0.45];
    let i = 0;
    while (i < kLuxelSizes.length - 2 && size > kLuxelSizes[i + 1]) i++;
    const share = Math.log(size / kLuxelSizes[i]) / Math.log(kLuxelSizes[i + 1] / kLuxelSizes[i]);
    const color = kTableColors[i].clone().lerp(kTableColors[i + 1], Math.min(Math.max(share, 0), 1));
    return [color.r, color.g, color.b];
}

/** Area of a triangle whose corners have `size` numbers each. */
function triangleArea(array, size, corners) {
    const edge = (to) =>
        [0, 1, 2].map((k) => (k < size ? array[size * corners[to] + k] - array[size * corners[0] + k] : 0));
    const [a, b] = [edge(1), edge(2)];
    return Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]) / 2;
}

/** Units along the edge of a luxel, on average over the surface; 0 if it has no lightmap. */
function luxelSize(shape, place) {
    if (!place) return 0;
    const pageSide = 0.5 / place.texel; // of a layer; the scale is the share of it that the page fills
    let [world, luxels] = [0, 0];
    for (let i = 0; i < shape.indexes.length; i += 3) {
        const corners = [0, 1, 2].map((k) => shape.indexes[i + k]);
        world += triangleArea(shape.vertices.position, 3, corners);
        luxels +=
            triangleArea(shape.vertices.lightmap, 2, corners) *
            place.scale[0] *
            place.scale[1] *
            pageSide *
            pageSide;
    }
    return luxels > 0 ? Math.sqrt(world / luxels) : 0;
}

/** Vertices and indexes of a surface; null if it is not drawn. */
function shapeOf(map, surface) {
    if (surface.type === SurfaceType.patch) return tessellate(map.vertices, surface);
    if (surface.type === SurfaceType.flare || surface.indexCount === 0) return null;
    const { firstVertex: first, vertexCount: count } = surface;
    const part = ([name, size]) => [name, map.vertices[name].subarray(size * first, size * (first + count))];
    return {
        vertices: { count, ...Object.fromEntries(fieldsOf(map.vertices).map(part)) },
        indexes: map.indexes.subarray(surface.firstIndex, surface.firstIndex + surface.indexCount),
    };
}

/** Offset of the models that entities place, by number of the model. */
function modelOffsets(entities) {
    const offsets = new Map();
    for (const entity of entities) {
        const number = /^\*(\d+)$/.exec(entity.get('model') ?? '');
        if (number) offsets.set(Number(number[1]), parseVector(entity.get('origin')) ?? [0, 0, 0]);
    }
    return offsets;
}

/** Surfaces with a shape, by what they are drawn with. */
function groupSurfaces(map, shaderOf, lightmaps, clusters) {
    const groups = new Map();
    const offsets = modelOffsets(map.entities);
    map.models.forEach((model, number) => {
        const offset = number === 0 ? [0, 0, 0] : (offsets.get(number) ?? [0, 0, 0]);
        for (let i = model.firstSurface; i < model.firstSurface + model.surfaceCount; i++) {
            const surface = map.surfaces[i];
            const record = map.shaders[surface.shader];
            const shader = shaderOf(record);
            const isForCollision = surface.type === SurfaceType.patch && (record.surfaceFlags & SurfaceFlag.noDraw) !== 0;
            const shape = shader.hidden || isForCollision ? null : shapeOf(map, surface);
            if (!shape) continue;
            const key = shader.sky
                ? 'sky'
                : [shader.image, shader.clamp, shader.blend, shader.alphaTest, shader.twoSided].join('|');
            if (!groups.has(key)) groups.set(key, { shader, pieces: [] });
            const places = lightmaps.placesOf(surface, shader);
            const layer = layerOf(shader, places[0]);
            groups.get(key).pieces.push({
                surface: i,
                shape,
                offset,
                shader,
                places,
                layer,
                styles: layer >= 0 ? surface.lightmapStyles : surface.vertexStyles,
                luxelSize: luxelSize(shape, places[0]),
                cluster: clusters[i][0] ?? -1,
            });
        }
    });
    return groups;
}

/** Layer of the lightmap, or where else the light of a surface comes from. */
function layerOf(shader, place) {
    if (shader.blend === 'filter') return kNoLight; // it only dims what is behind
    if (shader.light !== 'vertex' && shader.light !== 'none' && place) return place.layer;
    return shader.light === 'none' ? kNoLight : kVertexLight;
}

/** Lightmap coordinates and colors of a slot. */
function fillSlot(arrays, base, { shape, places, layer }, slot) {
    const { vertices } = shape;
    const place = places[slot];
    const source = { lightmap: vertices[lightmapField(slot)], color: vertices[colorField(slot)] };
    const target = { lightmap: arrays[lightmapField(slot)], color: arrays[colorField(slot)] };
    for (let i = 0; i < vertices.count; i++) {
        const to = base + i;
        if (place)
            for (let k = 0; k < 2; k++) {
                const inPage = Math.min(Math.max(source.lightmap[2 * i + k], 0), 1) * place.scale[k];
                target.lightmap[3 * to + k] = Math.min(Math.max(inPage, place.texel), place.scale[k] - place.texel);
            }
        target.lightmap[3 * to + 2] = slot === 0 ? layer : (place?.layer ?? kNoLight);
        const color = shiftColor([...source.color.subarray(4 * i, 4 * i + 3)].map(Math.round), kMapShift);
        target.color.set([...color, source.color[4 * i + 3]], 4 * to);
    }
}

function fillVertices(arrays, base, piece, slots) {
    const { vertices } = piece.shape;
    const { offset, shader, layer, styles } = piece;
    for (let slot = 0; slot < slots; slot++)
        if (slot === 0 || slot < styles.length) fillSlot(arrays, base, piece, slot);
        else arrays[lightmapField(slot)].fill(kNoLight, 3 * base, 3 * (base + vertices.count));
    const tint = clusterColor(piece.cluster);
    const luxels = luxelColor(layer >= 0 ? piece.luxelSize : 0);
    for (let i = 0; i < vertices.count; i++) {
        const to = base + i;
        for (let k = 0; k < 3; k++) arrays.position[3 * to + k] = vertices.position[3 * i + k] + offset[k];
        for (let k = 0; k < 2; k++) arrays.st[2 * to + k] = vertices.st[2 * i + k] * shader.scale[k];
        arrays.styles?.set(styles, kSlots * to);
        for (let k = 0; k < 3; k++) arrays.clusterColor[3 * to + k] = 255 * tint[k];
        for (let k = 0; k < 3; k++) arrays.luxelColor[3 * to + k] = 255 * luxels[k];
    }
}

/** Name, values for a vertex, type, and whether they are divided by their largest value. */
function attributesOf(slots) {
    const ofSlot = (slot) => [
        [lightmapField(slot), 3, Float32Array, false],
        [colorField(slot), 4, Uint8Array, true],
    ];
    return [
        ['position', 3, Float32Array, false],
        ['st', 2, Float32Array, false],
        ['clusterColor', 3, Uint8Array, true],
        ['luxelColor', 3, Uint8Array, true],
        ...Array.from({ length: slots }, (_, slot) => ofSlot(slot)).flat(),
        ...(slots > 1 ? [['styles', kSlots, Uint8Array, false]] : []),
    ];
}

/** Geometry of the pieces, with light of so many slots; `ranges` tells which indexes belong to which surface. */
function joinPieces(pieces, slots) {
    const vertexCount = pieces.reduce((sum, piece) => sum + piece.shape.vertices.count, 0);
    const indexCount = pieces.reduce((sum, piece) => sum + piece.shape.indexes.length, 0);
    const attributes = attributesOf(slots);
    const arrays = Object.fromEntries(
        attributes.map(([name, size, Type]) => [name, new Type(size * vertexCount)]),
    );
    const indexes = new Uint32Array(indexCount);
    const ranges = [];
    let [vertex, index] = [0, 0];
    for (const piece of pieces) {
        fillVertices(arrays, vertex, piece, slots);
        for (let i = 0; i < piece.shape.indexes.length; i++) indexes[index + i] = vertex + piece.shape.indexes[i];
        ranges.push({
            surface: piece.surface,
            first: index,
            count: piece.shape.indexes.length,
            layer: piece.layer,
            luxelSize: piece.luxelSize,
        });
        vertex += piece.shape.vertices.count;
        index += piece.shape.indexes.length;
    }
    const geometry = new THREE.BufferGeometry();
    for (const [name, size, , normalized] of attributes)
        geometry.setAttribute(name, new THREE.BufferAttribute(arrays[name], size, normalized));
    geometry.setIndex(new THREE.BufferAttribute(indexes.slice(), 1));
    return { geometry, indexes, ranges };
}

function materialOf(shader, shared, placeholder, slots) {
    const blend = shader.sky ? null : shader.blend;
    return new THREE.ShaderMaterial({
        glslVersion: THREE.GLSL3,
        vertexShader: kVertexShader,
        fragmentShader: kFragmentShader,
        uniforms: {
            ...shared,
            image: { value: placeholder },
            alphaTest: { value: shader.alphaTest },
            plainColor: { value: new THREE.Color(-1, -1, -1) },
        },
        defines: {
            ...(shader.alphaTest !== 0 ? { ALPHA_TEST: '' } : {}),
            ...(slots > 1 ? { STYLED: '' } : {}),
        },
        side: shader.twoSided ? THREE.DoubleSide : THREE.BackSide, // front faces of the game turn clockwise
        transparent: blend !== null,
        depthWrite: blend === null,
        ...(blend ? kBlending[blend] : {}),
    });
}

/** The drawn map: a group of meshes, its uniforms, and which surfaces are shown. */
export class MapMesh {
    group = new THREE.Group();
    batches = [];

    /**
     * @param map from readMap
     * @param {(shader: {name: string, surfaceFlags: number}) => object} shaderOf gives what readShader returns
     * @param {import('./lightmaps.js').Lightmaps} lightmaps
     * @param {number[][]} clusters of each surface
     * @param {import('./textures.js').Textures} textures
     * @param {{value: number}} brightness shared uniform
     * @param {THREE.Color} skyColor
     * @param {Float32Array} styleLight brightness of each of 256 light styles
     */
    constructor(map, shaderOf, lightmaps, clusters, textures, brightness, skyColor, styleLight) {
        this.clusters = clusters;
        this.uniforms = {
            lightmaps: { value: lightmaps.texture },
            textured: { value: 1 },
            tint: { value: 0 },
            cutHeight: { value: 0 },
            brightness,
            styleLight: { value: new THREE.DataTexture(styleLight, 256, 1, THREE.RedFormat, THREE.FloatType) },
        };
        this.styleLightChanged();
        const slots = map.styles.length > 0 ? kSlots : 1;
        this.triangles = 0;
        for (const [key, { shader, pieces }] of groupSurfaces(map, shaderOf, lightmaps, clusters)) {
            const joined = joinPieces(pieces, slots);
            const material = materialOf(
                shader,
                this.uniforms,
                shader.image === '$whiteimage' ? textures.white : textures.missing,
                slots,
            );
            if (key === 'sky') material.uniforms.plainColor.value = skyColor;
            const mesh = new THREE.Mesh(joined.geometry, material);
            mesh.frustumCulled = true;
            mesh.renderOrder = shader.blend && key !== 'sky' ? 1 : 0;
            this.group.add(mesh);
            this.triangles += joined.indexes.length / 3;
            this.batches.push({
                mesh,
                material,
                image: key === 'sky' ? '' : shader.image,
                clamp: shader.clamp,
                ...joined,
                shown: joined.ranges,
            });
        }
    }

    /** Takes over the brightness of light styles. */
    styleLightChanged() {
        this.uniforms.styleLight.value.needsUpdate = true;
    }

    /** Hides what is above a height; null: nothing. */
    cutAt(height) {
        this.uniforms.cutHeight.value = height ?? 0;
        for (const { material } of this.batches) {
            if ('CUT' in material.defines === (height !== null)) continue;
            if (height === null) delete material.defines.CUT;
            else material.defines.CUT = '';
            material.needsUpdate = true;
        }
    }

    /** Shows only surfaces in clusters for which the test holds; null: all. */
    showClusters(test) {
        for (const batch of this.batches) {
            const { geometry, indexes, ranges } = batch;
            const target = geometry.index.array;
            let count = 0;
            batch.shown = [];
            for (const range of ranges) {
                const clusters = this.clusters[range.surface];
                if (test && clusters.length > 0 && !clusters.some(test)) continue;
                target.set(indexes.subarray(range.first, range.first + range.count), count);
                batch.shown.push({ ...range, first: count });
                count += range.count;
            }
            geometry.index.needsUpdate = true;
            geometry.setDrawRange(0, count);
        }
    }

    /**
     * The nearest shown surface on a ray, with its place, the normal there on the side that the ray comes from, and its
     * luxel size; null: none.
     * @param {THREE.Raycaster} raycaster
     * @param {number | null} height above which the map is cut
     */
    surfaceOn(raycaster, height) {
        const hits = raycaster.intersectObjects(this.group.children);
        const hit = hits.find(({ point }) => height === null || point.z <= height);
        if (!hit) return null;
        const batch = this.batches.find(({ mesh }) => mesh === hit.object);
        const index = 3 * hit.faceIndex;
        const range = batch.shown.find(({ first, count }) => index >= first && index < first + count);
        if (!range) return null;
        const { array } = batch.geometry.index;
        const { position } = batch.geometry.attributes;
        const corners = [...array.subarray(range.first, range.first + range.count)];
        const triangles = new Float32Array(corners.flatMap((i) => [position.getX(i), position.getY(i), position.getZ(i)]));
        const normal = hit.face.normal.clone();
        if (normal.dot(raycaster.ray.direction) > 0) normal.negate();
        return { ...range, point: hit.point, normal, triangles };
    }

    dispose() {
        for (const { geometry, material } of this.batches) {
            geometry.dispose();
            material.dispose();
        }
        this.uniforms.lightmaps.value.dispose();
        this.uniforms.styleLight.value.dispose();
    }
}
