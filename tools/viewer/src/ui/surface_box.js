// GPL-2.0-or-later. The box that tells what the surface is that the visitor has clicked.
import { SurfaceType } from '../bsp/map.js';
import { make } from './controls.js';

const kTypes = new Map([
    [SurfaceType.planar, 'planar'],
    [SurfaceType.patch, 'curve'],
    [SurfaceType.triangles, 'triangles'],
]);

/** Where the light of a surface comes from. `layer` and `luxelSize` are those of MapMesh.surfaceOn. */
function lightOf(surface, shader, { layer, luxelSize }) {
    if (layer < 0) return [['Light', shader.light === 'none' || shader.blend === 'filter' ? 'none' : 'of its vertices']];
    return [
        ['Lightmap', shader.lightmapImage || `page ${surface.lightmap}`],
        ['Luxel size', `${luxelSize.toFixed(luxelSize < 10 ? 1 : 0)} units`],
    ];
}

/**
 * Shows a surface; null hides the box.
 * @param {HTMLElement} element
 * @param {import('../viewer.js').Viewer} viewer
 */
export function showSurface(element, viewer, close) {
    const { picked, map } = viewer;
    element.hidden = !picked;
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
    );
}
