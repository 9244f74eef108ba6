// GPL-2.0-or-later. What the colors on the screen mean.
import { kKindColors, kLevelColors } from '../scene/grid_layer.js';
import { kErrorScale } from '../scene/error_layer.js';
import { kLuxelColors, kLuxelSizes } from '../scene/map_mesh.js';
import { kUnexplainedScale } from '../scene/unexplained_layer.js';
import { make } from './controls.js';

const kKinds = ['lit: in the open', 'filled: in a wall, with light', 'void: no light'];
const css = (color) => `rgb(${color.map((c) => Math.round(255 * c)).join(' ')})`;

function entry(color, text) {
    const dot = make('i', {});
    dot.style.background = typeof color === 'string' ? color : css(color);
    return make('span', { class: 'entry' }, dot, text);
}

function levels(grid) {
    const used = new Set(grid.pointLevels);
    const size = Math.min(...grid.cell);
    return [...used].sort((a, b) => a - b).map((level) => entry(kLevelColors[level], `${size * 2 ** level} units`));
}

function scale(title, colors, ticks) {
    const bar = make('div', { class: 'scale' });
    bar.style.background = `linear-gradient(to right, ${colors.join(', ')})`;
    const marks = make('div', { class: 'ticks' }, ...ticks.map((tick) => make('span', {}, tick)));
    return make('div', { class: 'scaleBox' }, make('span', {}, title), bar, marks);
}

function errorScale({ settings, errors }) {
    const title = `${settings.errors === 'sh' ? 'SH' : 'Legacy'} grid, error in ${errors.errors.unit}`;
    const end = settings.largest;
    return scale(title, kErrorScale, ['0', String(end / 2), `${end}+`]);
}

function unexplainedScale({ settings, unexplained }) {
    const end = settings.mostUnexplained;
    const ticks = [`${end}+ darker`, 'as explained', `${end}+ lighter`];
    return scale(`Map compared with explained light, in ${unexplained.light.unit}`, kUnexplainedScale, ticks);
}

/** What the legend depends on. */
function stateOf({ settings, path, grids, errors, unexplained }) {
    const { showPoints, color, source, figure, errors: shown, largest, tint } = settings;
    const counts = [grids[source]?.count, errors.errors?.count, unexplained.light?.count];
    const scales = [shown, largest, settings.unexplained, settings.mostUnexplained];
    return [showPoints, color, source, figure, tint, path, ...scales, ...counts].join('|');
}

/** Shows the meaning of the colors in use; nothing if they are plain light. */
export function showLegend(element, viewer) {
    const { settings, grids } = viewer;
    const state = stateOf(viewer);
    if (element.dataset.state === state) return;
    element.dataset.state = state;
    const parts = [];
    if (settings.showPoints && settings.color === 'kind' && grids[settings.source])
        parts.push(make('div', {}, ...kKindColors.map((color, i) => entry(color, kKinds[i]))));
    if (settings.showPoints && settings.color === 'level' && settings.source === 'sparse' && grids.sparse)
        parts.push(make('div', {}, 'Cells: ', ...levels(grids.sparse)));
    if (settings.tint === 'luxels')
        parts.push(
            make(
                'div',
                {},
                'Luxel size: ',
                ...kLuxelSizes.map((size, i) => entry(kLuxelColors[i], `${size} units`)),
                entry([0.45, 0.45, 0.45], 'no lightmap'),
            ),
        );
    if (settings.figure === 'both') parts.push(make('div', {}, 'Figures: SH on the left, legacy on the right'));
    if (settings.errors !== 'off' && viewer.errors.errors) parts.push(errorScale(viewer));
    if (settings.unexplained && viewer.unexplained.light) parts.push(unexplainedScale(viewer));
    element.replaceChildren(...parts);
    element.hidden = parts.length === 0;
}
