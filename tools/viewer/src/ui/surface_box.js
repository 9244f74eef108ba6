// GPL-2.0-or-later. The box that tells what the surface is that the visitor has clicked, and why it is lit as it is.
import { SurfaceType } from '../bsp/map.js';
import { make } from './controls.js';

const kTypes = new Map([
    [SurfaceType.planar, 'planar'],
    [SurfaceType.patch, 'curve'],
    [SurfaceType.triangles, 'triangles'],
]);

/** The page of a surface's lightmap; if it has several light styles, the page of each. */
function pagesOf({ pages, lightmapStyles }) {
    if (lightmapStyles.every((style) => style === 0)) return `page ${pages[0]}`;
    return lightmapStyles.map((style, slot) => `page ${pages[slot]} (style ${style})`).join(', ');
}

/** Where the light of a surface comes from. `layer` and `luxelSize` are those of MapMesh.surfaceOn. */
function lightOf(surface, shader, { layer, luxelSize }) {
    if (layer < 0) return [['Light', shader.light === 'none' || shader.blend === 'filter' ? 'none' : 'of its vertices']];
    return [
        ['Lightmap', shader.lightmapImage || pagesOf(surface)],
        ['Luxel size', `${luxelSize.toFixed(luxelSize < 10 ? 1 : 0)} units`],
    ];
}

const kOpenAtFirst = /^(Lights|Nearest luxel)/;

/** The sections of a report: each begins with a line that is not indented. */
function sectionsOf(text) {
    const sections = [];
    for (const line of text.trimEnd().split('\n'))
        if (sections.length > 0 && line.startsWith(' ')) sections.at(-1).lines.push(line);
        else sections.push({ title: line, lines: [] });
    return sections;
}

/** A line of a report, whose indent stays where it is broken. */
function lineOf(line) {
    const indent = line.length - line.trimStart().length;
    const row = make('div', {}, line.trimStart());
    row.style.paddingLeft = `${indent + 2}ch`;
    return row;
}

/** The command that explains the light at a point of the surface itself. */
function commandFor(path, options, point) {
    return `q3map2 -light ${options ? `${options} ` : ''}-explain ${point} ${path}`;
}

/** Why the place nearest to the click is lit as it is. */
function explanationOf({ explained, explanations, picked, path }) {
    const clicked = picked.point.toArray();
    const away = Math.hypot(...explained.at.map((x, axis) => x - clicked[axis]));
    const sections = sectionsOf(explained.text).map(({ title, lines }) =>
        lines.length === 0
            ? make('p', {}, title)
            : make(
                  'details',
                  { open: kOpenAtFirst.test(title) },
                  make('summary', {}, title),
                  make('div', { class: 'lines' }, ...lines.map(lineOf)),
              ),
    );
    return make(
        'div',
        { class: 'explanation' },
        make('h2', {}, `Its light, explained ${away.toFixed(0)} units from here`),
        ...sections,
        make('p', { class: 'note' }, 'For the place itself:'),
        make('code', {}, commandFor(path, explanations.options, clicked.map((c) => c.toFixed(0)).join(' '))),
    );
}

/**
 * Shows a surface; null hides the box.
 * @param {HTMLElement} element
 * @param {import('../viewer.js').Viewer} viewer
 */
export function showSurface(element, viewer, close) {
    const { picked, map } = viewer;
    element.hidden = !picked;
    if (element.picked === picked) return; // the box stays as it is, scrolled and opened, from frame to frame
    element.picked = picked;
    if (!picked) return;
    const surface = map.surfaces[picked.surface];
    const record = map.shaders[surface.shader];
    const rows = [
        ['Shader', record.name],
        ['Surface', `${picked.surface}, ${kTypes.get(surface.type) ?? 'unknown type'}`],
        ...lightOf(surface, viewer.shaderOf(record), picked),
        ['Place', picked.point.toArray().map((c) => c.toFixed(0)).join(' ')],
    ];
    element.replaceChildren(
        make('button', { type: 'button', 'aria-label': 'Close', click: close }, '×'),
        make('dl', { class: 'facts' }, ...rows.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)])),
        ...(viewer.explained ? [explanationOf(viewer)] : []),
    );
}
