// GPL-2.0-or-later. Parses of shader scripts what a still picture of a surface needs.
import { SurfaceFlag } from '../bsp/map.js';

/** Lines as words; a brace is a line of its own, comments are left out. */
function* lines(text) {
    const clean = text
        .replace(/\/\*[\s\S]*?\*\//g, ' ')
        .replace(/\/\/[^\n\r]*/g, '')
        .replace(/[{}]/g, '\n$&\n');
    for (const line of clean.split(/[\n\r]+/)) {
        const words = line.trim().split(/\s+/);
        if (words[0] !== '') yield words.map((word) => word.replace(/^"|"$/g, ''));
    }
}

/**
 * Splits a script into shaders.
 * @returns {Map<string, string[][]>} lines between the outer braces by name; the first of two with one name
 */
export function splitScript(text) {
    const shaders = new Map();
    let name = '';
    let depth = 0;
    let body = [];
    for (const words of lines(text)) {
        if (words[0] === '}') depth = Math.max(depth - 1, 0);
        if (depth > 0) {
            body.push(words);
        } else if (words[0] === '}') {
            if (!shaders.has(name)) shaders.set(name, body);
            body = [];
        } else if (words[0] !== '{') {
            name = words[0].toLowerCase().replaceAll('\\', '/');
        }
        if (words[0] === '{') depth++;
    }
    return shaders;
}

function blendOf(words) {
    const short = { add: 'add', gl_add: 'add', blend: 'blend', filter: 'filter' }[words[1]?.toLowerCase()];
    if (short) return short;
    const [source, target] = [words[1]?.toUpperCase(), words[2]?.toUpperCase()];
    if (source === 'GL_ONE' && target === 'GL_ZERO') return null;
    if (source === 'GL_DST_COLOR' || target === 'GL_SRC_COLOR') return 'filter';
    if (source === 'GL_SRC_ALPHA' && target === 'GL_ONE_MINUS_SRC_ALPHA') return 'blend';
    if (target === 'GL_ONE_MINUS_SRC_ALPHA' || source === 'GL_ONE_MINUS_SRC_ALPHA') return 'blend';
    return 'add';
}

/** Handlers of the keywords of a stage. */
const kStageWords = {
    map: (stage, words) => {
        stage.image = words[1];
    },
    clampmap: (stage, words) => {
        stage.image = words[1];
        stage.clamp = true;
    },
    animmap: (stage, words) => {
        stage.image = words[2];
    },
    blendfunc: (stage, words) => {
        stage.blend = blendOf(words);
    },
    alphafunc: (stage, words) => {
        stage.alphaTest = { gt0: 0.004, lt128: -0.5, ge128: 0.5 }[words[1]?.toLowerCase()] ?? 0;
    },
    rgbgen: (stage, words) => {
        stage.vertexColor = /^(exact)?vertex$/i.test(words[1] ?? '');
    },
    tcgen: (stage, words) => {
        stage.environment = /^environment$/i.test(words[1] ?? '');
        stage.onLightmap = /^lightmap$/i.test(words[1] ?? '');
    },
    tcmod: (stage, words) => {
        if (/^scale$/i.test(words[1] ?? '')) stage.scale = [Number(words[2]) || 1, Number(words[3]) || 1];
    },
};

function newStage() {
    return {
        image: '',
        clamp: false,
        blend: null,
        alphaTest: 0,
        vertexColor: false,
        environment: false,
        onLightmap: false,
        scale: [1, 1],
    };
}

/** Keywords and stages of a shader's text. */
function parseBody(body) {
    const shader = { parms: new Set(), stages: [], twoSided: false };
    let stage = null;
    for (const words of body) {
        const key = words[0].toLowerCase();
        if (key === '{') {
            if (!stage) shader.stages.push((stage = newStage()));
        } else if (key === '}') {
            stage = null;
        } else if (stage) {
            kStageWords[key]?.(stage, words);
        } else if (key === 'surfaceparm') {
            shader.parms.add(words[1]?.toLowerCase());
        } else if (key === 'cull') {
            shader.twoSided = /^(none|disable|twosided)$/i.test(words[1] ?? '');
        }
    }
    return shader;
}

/** Whether a stage has a lightmap, of the map or of an image beside it. */
function isLightmap(stage) {
    return stage.onLightmap || stage.image.toLowerCase() === '$lightmap';
}

/** The stage that looks most like the surface: one with an image of its own, rather not a reflection. */
function mainStage(stages) {
    const own = stages.filter((stage) => !isLightmap(stage) && stage.image !== '');
    return own.find((stage) => !stage.environment) ?? own[0] ?? null;
}

/**
 * How to draw surfaces with a shader.
 * image: path of the texture, with or without extension; lightmapImage: that of its lightmap beside the map, or '';
 * blend: null, 'add', 'blend' or 'filter'; alphaTest: 0 draws all texels, a > 0 those with alpha >= a, a < 0 those with
 * alpha < -a;
 * light: 'lightmap', 'vertex', 'none' or, without a script, 'any'.
 * @param {string} name of the shader, lower case
 * @param {string[][]|undefined} body from splitScript; undefined: no script, the image has the name of the shader
 * @param {number} surfaceFlags those in the map, which stand for the surfaceparms where there is no script
 */
export function readShader(name, body, surfaceFlags = 0) {
    const plain = {
        image: name,
        lightmapImage: '',
        clamp: false,
        blend: null,
        alphaTest: 0,
        twoSided: false,
        light: 'any',
        scale: [1, 1],
        hidden: false,
        sky: false,
    };
    if (!body) return { ...plain, sky: (surfaceFlags & SurfaceFlag.sky) !== 0, hidden: (surfaceFlags & SurfaceFlag.noDraw) !== 0 };
    const { parms, stages, twoSided } = parseBody(body);
    const stage = mainStage(stages);
    const lightmap = stages.find(isLightmap);
    const path = (image) => (image ?? '').toLowerCase().replaceAll('\\', '/');
    // Blending counts where nothing opaque lies below; over a lightmap it joins the two.
    const blend = stage && stages[0].blend && !isLightmap(stages[0]) ? (stage.blend ?? stages[0].blend) : null;
    return {
        ...plain,
        image: path(stage?.image),
        clamp: stage?.clamp ?? false,
        blend,
        alphaTest: stage?.alphaTest ?? 0,
        twoSided,
        lightmapImage: lightmap?.onLightmap && lightmap.image[0] !== '$' ? path(lightmap.image) : '',
        light: lightmap ? 'lightmap' : stage?.vertexColor ? 'vertex' : 'none',
        scale: stage?.scale ?? [1, 1],
        hidden: parms.has('nodraw') || (!stage && !lightmap && !parms.has('sky')),
        sky: parms.has('sky'),
    };
}
