// GPL-2.0-or-later. The scene: a map with its layers, drawn when something has changed.
import * as THREE from 'three';
import { lightEntities, namesOfStyle, startPosition } from './bsp/entities.js';
import { onlyStyle0 } from './bsp/grid_styled.js';
import { readGrids } from './bsp/grids.js';
import { parseTone } from './bsp/sh.js';
import { BspTree } from './bsp/tree.js';
import { readShader } from './files/shader_script.js';
import { ErrorLayer } from './scene/error_layer.js';
import { nearestPlace } from './scene/explained.js';
import { Figure } from './scene/figure.js';
import { GridLayer } from './scene/grid_layer.js';
import { Lightmaps } from './scene/lightmaps.js';
import { MapMesh } from './scene/map_mesh.js';
import { disposeTree, leakLine, lightRays, lightSpheres, placeDots, placeMark, portalMesh, surfaceMark } from './scene/overlays.js';
import { Textures } from './scene/textures.js';
import { UnexplainedLayer } from './scene/unexplained_layer.js';
import { Walk } from './scene/walk.js';
import { initialSettings } from './settings.js';
import { linkTo, placeOf } from './place_link.js';

const kSkyColor = new THREE.Color().setStyle('#5f7f9e', THREE.LinearSRGBColorSpace);
const kBackground = new THREE.Color().setStyle('#14171c', THREE.LinearSRGBColorSpace);
const kTints = ['off', 'clusters', 'luxels'];
const kFigureDistance = 96; // units before the viewer
const kFigureDrop = 20; // units below the line of sight
const [kSeeFrom, kSeePitches, kSeeYaws] = [[160, 280, 96, 56], [0.4, 0, -0.4], 8]; // from where a point is looked at: units, radians
const kRefreshShare = 0.04; // of the radius: how far the viewer moves before points are chosen anew

/** Resolves after the browser has shown what was drawn. */
function nextFrame() {
    return new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
}

/** A position in the open, and in front of nothing solid as seen from near the point; null: none of those tried. */
function placeToSee(point, tree) {
    for (const distance of kSeeFrom)
        for (const pitch of kSeePitches)
            for (let step = 0; step < kSeeYaws; step++) {
                const yaw = (2 * Math.PI * step) / kSeeYaws;
                const way = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
                const at = (share) => point.map((c, i) => c + share * distance * way[i]);
                if ([0.4, 0.6, 0.8, 1].every((share) => tree.clusterAt(...at(share)) >= 0)) return at(1);
            }
    return null;
}

export class Viewer {
    settings = initialSettings();
    map = null;
    grids = { uniform: null, sparse: null, legacy: null, problems: [] };
    /** What the last frames took and drew. */
    stats = { firstPicture: 0, texturesDone: 0, fps: 0, calls: 0, triangles: 0 };
    figureLight = null;
    errorSummary = null;
    unexplainedSummary = null;
    /** The surface that the visitor has clicked, from MapMesh.surfaceOn. */
    picked = null;
    /** From parseExplanations, and its place that is nearest to the click. */
    explanations = null;
    explained = null;
    /** Light entities of the map source; null: those of the map. */
    givenLights = null;
    /** Called once after the first picture of the next map. */
    shownFirst = () => {};
    imagesRevision = -1;

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {() => void} drawn called after each frame
     * @throws if the browser has no WebGL 2
     */
    constructor(canvas, drawn) {
        this.drawn = drawn;
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance' });
        this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // light is shown as in the game, byte for byte
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.renderer.setClearColor(kBackground);
        this.camera = new THREE.PerspectiveCamera(62, 1, 2, 65536);
        this.scene = new THREE.Scene();
        this.lightUniforms = {
            brightness: { value: 1 },
            tone: { value: new THREE.Vector4(1, 1, 0, 1) },
            tone2: { value: new THREE.Vector3(1, 1, 0) },
        };
        this.textures = new Textures(this.isSoftware() ? 1 : 4);
        this.gridLayer = new GridLayer(this.lightUniforms);
        this.figure = new Figure(this.lightUniforms);
        this.errors = new ErrorLayer();
        this.unexplained = new UnexplainedLayer();
        this.side = { leak: null, portals: null, lights: null, places: null, mark: null, rays: null, goal: null };
        this.scene.add(this.gridLayer.mesh, this.figure.group, this.errors.dots.mesh, this.unexplained.dots.mesh);
        this.raycaster = new THREE.Raycaster();
        this.walk = new Walk(this.camera, canvas, {
            changed: () => this.invalidate(),
            grab: (event) => this.grabFigure(event),
            drag: (event) => this.dragFigure(event),
            click: (event) => this.pick(event),
        });
        new ResizeObserver(() => this.resize()).observe(canvas);
        this.resize();
    }

    /** Whether WebGL runs on the processor, where filtering textures is slow. */
    isSoftware() {
        const gl = this.renderer.getContext();
        const info = gl.getExtension('WEBGL_debug_renderer_info');
        return /swiftshader|llvmpipe|software/i.test(
            String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)),
        );
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
        if (width === 0 || height === 0) return;
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.invalidate();
    }

    /**
     * Shows a map in place of the one before, first with its lightmaps alone, then with its grids. The viewer stays
     * where they are if it is the same map again, with more files.
     * @param map from readMap
     * @param {string} path of the map, such as maps/x.bsp
     * @param {import('./files/game_files.js').GameFiles} files
     * @param {Map<string, string[][]>} scripts shaders by name
     * @param {number} started time at which the visitor opened it, from performance.now()
     */
    async open(map, path, files, scripts, started) {
        const tree = new BspTree(map.tree);
        const shaders = new Map();
        const shaderOf = ({ name, surfaceFlags }) => {
            const record = `${surfaceFlags} ${name}`; // records of one name differ in flags
            if (!shaders.has(record)) shaders.set(record, readShader(name, scripts.get(name), surfaceFlags));
            return shaders.get(record);
        };
        map.shaders.forEach(shaderOf);
        const name = path
            .slice(path.lastIndexOf('/') + 1)
            .replace(/\.bsp$/i, '')
            .toLowerCase();
        const images = [
            ...new Set([...shaders.values()].map((shader) => shader.lightmapImage).filter((image) => image !== '')),
        ];
        const lightmaps = await Lightmaps.load(
            map,
            name,
            images,
            files,
            this.renderer.capabilities.maxArrayTextureLayers ?? 256,
        );
        const again = this.map !== null && this.path === path;
        // Programs of the graphics system are compiled anew unless something still uses them.
        const old = again ? this.mesh : null;
        this.close({ keepMesh: again, keepTextures: again && files.revision === this.imagesRevision });
        this.imagesRevision = files.revision;
        Object.assign(this, { map, path, tree, lightmaps, shaderOf });
        if (!again) this.settings.styleLight.set(onlyStyle0());
        this.setTone(map.entities[0]?.get('_q3map2_tone'));
        this.mesh = new MapMesh(
            map,
            shaderOf,
            lightmaps,
            tree.surfaceClusters(map.surfaces.length),
            this.textures,
            this.lightUniforms.brightness,
            kSkyColor,
            this.settings.styleLight,
        );
        this.textures.apply(this.mesh.batches);
        this.scene.add(this.mesh.group);
        if (!again) this.toPlace(placeOf(location.hash, path));
        this.applySettings();
        this.drawNow();
        this.finish();
        old?.dispose();
        this.stats.firstPicture = performance.now() - started;
        this.shownFirst();
        await nextFrame();
        this.grids = readGrids(map);
        if (this.grids.legacy) this.grids.legacy.styleLight = this.settings.styleLight;
        this.chooseGrid();
        this.addLights();
        this.changed();
    }

    /** Waits until the graphics system has drawn. */
    finish() {
        const gl = this.renderer.getContext();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }

    /** Loads the textures of the map that `open` shows; the picture is drawn again as they come. */
    async loadTextures(files, started) {
        const { map } = this;
        await this.textures.loadAll(
            this.mesh.batches,
            files,
            () => this.map === map,
            () => this.invalidate(),
        );
        if (this.map !== map) return;
        this.stats.texturesDone = performance.now() - started;
        this.invalidate();
    }

    /** @param {{keepMesh?: boolean, keepTextures?: boolean}} options what the next map still needs, or its caller frees */
    close({ keepMesh = false, keepTextures = false } = {}) {
        if (!this.map) return;
        this.scene.remove(this.mesh.group);
        if (!keepMesh) this.mesh.dispose();
        if (!keepTextures) this.textures.dispose();
        for (const name of Object.keys(this.side)) this.setSide(name, null);
        this.errors.set(null);
        this.unexplained.set(null);
        this.picked = this.explained = this.explanations = null;
        this.grids = { uniform: null, sparse: null, legacy: null, problems: [] };
        this.map = null;
        this.shownCluster = undefined;
    }

    /** Light styles that the map has beside style 0, with the names of their lights. */
    get styles() {
        const styles = new Set([...(this.map?.styles ?? []), ...(this.grids.legacy?.styles ?? [])]);
        return [...styles]
            .sort((a, b) => a - b)
            .map((style) => ({ style, names: namesOfStyle(this.map.entities, style) }));
    }

    setTone(text) {
        const { tone, valid } = parseTone(text);
        this.toneProblem = valid ? null : 'The tone of the lightmaps, in worldspawn, cannot be read.';
        this.lightUniforms.tone.value.set(tone.contrast, 1 / tone.gamma, tone.exposure, tone.saturation);
        this.lightUniforms.tone2.value.set(tone.scale, tone.maxlight / 255, tone.srgb ? 1 : 0);
    }

    /** To a start of players, or over the middle of the world. */
    toStart() {
        const { mins, maxs } = this.map.models[0];
        const start = startPosition(this.map.entities) ?? {
            position: mins.map((low, i) => (low + maxs[i]) / 2),
            yaw: 0,
        };
        this.camera.position.fromArray(start.position);
        this.walk.yaw = (start.yaw * Math.PI) / 180;
        this.walk.pitch = 0;
        this.settings.height = Math.round(start.position[2] / 8) * 8;
        this.invalidate();
    }

    /** @param {{position: number[], yaw: number, pitch: number} | null} place null: a start of players */
    toPlace(place) {
        this.toStart();
        if (!place) return;
        this.camera.position.fromArray(place.position);
        this.walk.yaw = place.yaw;
        this.walk.pitch = place.pitch;
    }

    /** Brings the camera to a place in the open that sees the point, if there is one, turned to it, and marks the point. */
    lookAt(point) {
        const eye = placeToSee(point, this.tree) ?? this.walk.forward().multiplyScalar(-kSeeFrom[0]).toArray().map((c, i) => c + point[i]);
        const [dx, dy, dz] = point.map((c, i) => c - eye[i]);
        this.camera.position.fromArray(eye);
        this.walk.yaw = Math.atan2(dy, dx);
        this.walk.pitch = Math.atan2(dz, Math.hypot(dx, dy));
        this.setSide('goal', placeMark(point));
        this.invalidate();
    }

    /** The part of an address that leads here. */
    link() {
        return linkTo(this.path, this.camera.position.toArray(), this.walk.yaw, this.walk.pitch);
    }

    /** @returns {Promise<Blob>} the picture as a PNG */
    picture() {
        this.drawNow();
        return new Promise((resolve) => this.renderer.domElement.toBlob(resolve, 'image/png'));
    }

    /**
     * Above the world, looking straight down. The figure stays where it is.
     * @param {number} right width in pixels that the panel covers on the right
     * @param {number} bottom height in pixels that it covers at the bottom
     */
    fromAbove(right = 0, bottom = 0) {
        const { mins, maxs } = this.map.models[0];
        const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
        const [spanX, spanY] = [maxs[0] - mins[0], maxs[1] - mins[1]];
        const unitsPerPixel = 1.08 * Math.max(spanX / (width - right), spanY / (height - bottom));
        const distance = (unitsPerPixel * height) / 2 / Math.tan((this.camera.fov * Math.PI) / 360);
        const top = this.settings.cut || this.settings.where === 'slice' ? this.settings.height : maxs[2];
        const middle = [
            (mins[0] + maxs[0] + right * unitsPerPixel) / 2,
            (mins[1] + maxs[1] - bottom * unitsPerPixel) / 2,
        ];
        this.camera.position.set(...middle, top + distance);
        this.walk.yaw = Math.PI / 2;
        this.walk.pitch = -Math.PI / 2;
        this.settings.follow = false;
        this.invalidate();
    }

    /** The finest SH grid that the map has, else the legacy one. */
    chooseGrid() {
        const has = ['sparse', 'uniform', 'legacy'].filter((name) => this.grids[name]);
        if (!this.grids[this.settings.source]) this.settings.source = has[0] ?? 'uniform';
    }

    /** The SH grid that lights the figure. */
    get gridSH() {
        const { source } = this.settings;
        return (source === 'legacy' ? null : this.grids[source]) ?? this.grids.uniform ?? this.grids.sparse;
    }

    setSide(name, object) {
        const old = this.side[name];
        if (old) disposeTree(old);
        this.side[name] = object;
        if (object) this.scene.add(object);
    }

    /** @param {number[][]|null} points null: there is no leak */
    setLeak(points) {
        this.setSide('leak', points && leakLine(points));
        this.changed();
    }

    setPortals(file) {
        this.setSide('portals', portalMesh(file.portals));
        this.settings.portals = true;
        this.changed();
    }

    setErrors(errors) {
        this.errors.set(errors);
        this.settings.errors = 'sh';
        this.settings.largest = this.errors.dots.suggestedLargest;
        this.changed();
    }

    setUnexplained(light) {
        const meshOf = ({ geometry, indexes }) => ({ vertices: geometry.attributes.position.array, indexes });
        this.unexplained.set(light, this.mesh.batches.map(meshOf));
        this.settings.unexplained = true;
        this.settings.mostUnexplained = this.unexplained.dots.suggestedLargest;
        this.changed();
    }

    setExplanations(explanations) {
        this.explanations = explanations;
        this.setSide('places', placeDots(explanations.places));
        this.pick(null);
        this.changed();
    }

    addLights() {
        this.lightList = lightEntities(this.givenLights ?? this.map.entities);
        if (this.lightList.length > 0) this.setSide('lights', lightSpheres(this.lightList, this.lightUniforms).mesh);
    }

    /** Brings all layers in line with the settings. */
    changed() {
        this.gridStale = true;
        this.applySettings();
        this.invalidate();
    }

    applySettings() {
        const { settings } = this;
        this.lightUniforms.brightness.value = settings.brightness;
        this.walk.speed = settings.speed;
        for (const name of Object.keys(this.side)) if (this.side[name]) this.side[name].visible = settings[name] ?? true;
        if (!this.mesh) return;
        this.mesh.uniforms.textured.value = settings.textured ? 1 : 0;
        this.mesh.styleLightChanged();
        this.mesh.uniforms.tint.value = kTints.indexOf(settings.tint);
        this.mesh.cutAt(this.cutHeight);
        this.errorSummary = this.errors.update(settings.errors, settings);
        const { unexplained, mostUnexplained } = settings;
        this.unexplainedSummary = this.unexplained.update(unexplained, mostUnexplained, this.cutHeight);
    }

    /** Height above which the map is cut; null: it is not. */
    get cutHeight() {
        const { cut, height, thickness } = this.settings;
        return cut ? height + thickness / 2 : null;
    }

    refreshGrid() {
        const { settings } = this;
        const viewer = this.camera.position.toArray();
        const moved = this.gridViewer ? Math.hypot(...viewer.map((c, i) => c - this.gridViewer[i])) : Infinity;
        this.gridLayer.mesh.visible = settings.showPoints;
        if (!settings.showPoints || (!this.gridStale && moved < kRefreshShare * settings.radius)) return;
        const options = {
            ...settings,
            viewer,
            openOnly: !settings.inWalls,
            color: settings.source !== 'sparse' && settings.color === 'level' ? 'light' : settings.color,
        };
        this.gridLayer.update(this.grids[settings.source], this.tree, options);
        this.gridStale = false;
        this.gridViewer = viewer;
    }

    refreshClusters() {
        const cluster = this.tree.clusterAt(...this.camera.position.toArray());
        const wanted = this.settings.onlyVisible ? cluster : null;
        if (wanted === this.shownCluster) return;
        this.shownCluster = wanted;
        this.mesh.showClusters(wanted === null ? null : (other) => this.tree.sees(cluster, other));
    }

    refreshFigure() {
        const { settings, figure } = this;
        if (settings.figure !== 'off' && settings.follow) {
            figure.origin.copy(this.camera.position).addScaledVector(this.walk.forward(), kFigureDistance);
            figure.origin.z -= kFigureDrop;
        }
        this.figureLight = figure.update(
            settings.figure,
            this.walk.yaw + Math.PI,
            this.grids,
            this.gridSH,
            settings.minLight,
        );
    }

    rayOf(event) {
        const box = this.renderer.domElement.getBoundingClientRect();
        const at = new THREE.Vector2(
            (2 * (event.clientX - box.left)) / box.width - 1,
            1 - (2 * (event.clientY - box.top)) / box.height,
        );
        this.raycaster.setFromCamera(at, this.camera);
        return this.raycaster;
    }

    /** Marks the surface under the pointer; null: none. */
    pick(event) {
        if (!this.map) return;
        this.picked = event && this.mesh.surfaceOn(this.rayOf(event), this.cutHeight);
        this.explained = this.picked && this.explanations ? nearestPlace(this.explanations.places, this.picked) : null;
        this.setSide('mark', this.picked ? surfaceMark(this.picked.triangles) : null);
        this.setSide('rays', this.explained ? lightRays(this.explained) : null);
        this.invalidate();
    }

    grabFigure(event) {
        if (!this.figure.isHit(this.rayOf(event))) return false;
        const normal = this.walk.forward().negate();
        this.dragPlane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, this.figure.origin);
        this.dragOffset =
            this.raycaster.ray.intersectPlane(this.dragPlane, new THREE.Vector3())?.sub(this.figure.origin) ??
            new THREE.Vector3();
        this.settings.follow = false;
        return true;
    }

    dragFigure(event) {
        const at = this.rayOf(event).ray.intersectPlane(this.dragPlane, new THREE.Vector3());
        if (at) this.figure.origin.copy(at.sub(this.dragOffset));
    }

    /** Moves the figure by units away, right and up as the viewer sees it. */
    moveFigure(away, right, up) {
        const flat = new THREE.Vector3(Math.cos(this.walk.yaw), Math.sin(this.walk.yaw), 0);
        this.figure.origin.addScaledVector(flat, away).addScaledVector(this.walk.right(), right);
        this.figure.origin.z += up;
        this.settings.follow = false;
        this.invalidate();
    }

    /** Asks for a frame. */
    invalidate() {
        this.frameRequest ??= requestAnimationFrame((now) => this.frame(now));
    }

    frame(now) {
        this.frameRequest = null;
        const seconds = Math.min((now - (this.lastFrame ?? now)) / 1000, 0.1);
        const moving = this.walk.step(this.running ? seconds : 0);
        this.measure(now, seconds);
        this.lastFrame = now;
        this.running = moving;
        this.drawNow();
        this.drawn();
        if (moving) this.invalidate();
    }

    /** Frames a second, from frames that follow each other while moving. */
    measure(now, seconds) {
        if (!this.running) this.frameTimes = [];
        else if (seconds > 0) this.frameTimes.push(seconds);
        if (this.frameTimes.length > 40) this.frameTimes.shift();
        const sum = this.frameTimes.reduce((total, time) => total + time, 0);
        if (this.frameTimes.length > 0) this.stats.fps = this.frameTimes.length / sum;
    }

    drawNow() {
        this.walk.apply();
        if (this.map) {
            this.refreshGrid();
            this.refreshClusters();
            this.refreshFigure();
        }
        this.renderer.render(this.scene, this.camera);
        this.stats.calls = this.renderer.info.render.calls;
        this.stats.triangles = this.renderer.info.render.triangles;
    }
}
