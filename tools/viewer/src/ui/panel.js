// GPL-2.0-or-later. The panel: every setting, the figures of the map, and what the figure's light is.
import { button, checkbox, choice, make, section, slider } from './controls.js';

const number = (n) => n.toLocaleString('en-US');
const vector = (v, digits) => v.map((c) => c.toFixed(digits)).join(' ');

export class Panel {
    /**
     * @param {HTMLElement} element
     * @param {import('../viewer.js').Viewer} viewer
     * @param {{chooseMap: (path: string) => void, copyLink: () => void, savePicture: () => void}} actions
     */
    constructor(element, viewer, actions) {
        this.viewer = viewer;
        this.element = element;
        this.actions = actions;
        this.controls = [];
        this.styleControls = [];
        this.facts = make('dl', { class: 'facts' });
        this.absent = make('details', { class: 'absent', hidden: true });
        this.mapList = make('select', {
            title: 'Map',
            'aria-label': 'Map',
            change: () => actions.chooseMap(this.mapList.value),
        });
        this.values = make('pre', { class: 'values', 'aria-label': 'Light at the figure' });
        this.pointCount = make('p', { class: 'note' });
        this.errorCount = make('p', { class: 'note' });
        this.unexplainedCount = make('p', { class: 'note' });
        element.append(
            this.mapSection(),
            this.viewSection(),
            this.styleSection(),
            this.pointSection(),
            this.figureSection(),
            this.sliceSection(),
            this.unexplainedSection(),
            this.partSection(),
        );
        this.show();
    }

    /** Over the map, in the part of the page that the panel leaves. */
    fromAbove() {
        const { hidden, offsetWidth, offsetHeight } = this.element;
        const beside = offsetWidth < innerWidth / 2;
        this.viewer.fromAbove(beside && !hidden ? offsetWidth : 0, beside || hidden ? 0 : offsetHeight);
        this.show();
    }

    change = (key, value) => {
        this.viewer.settings[key] = value;
        this.viewer.changed();
        this.show();
    };

    add(control) {
        this.controls.push(control);
        this[control.key] = control;
        return control.row;
    }

    mapSection() {
        const buttons = make(
            'div',
            { class: 'buttons' },
            button('Start', () => this.viewer.toStart(), 'To a start of players (Home)'),
            button('From above', () => this.fromAbove(), 'Over the map, looking down (End)'),
            button(
                'Copy link',
                () => this.actions.copyLink(),
                'The address of this page with the place where you are: for somebody who has the same map, or this report',
            ),
            button('Save picture', () => this.actions.savePicture(), 'What you see, as a PNG'),
            button(
                'Mouse look',
                () => this.viewer.walk.lock(),
                'The mouse turns the view until Escape (double click)',
                'mouse',
            ),
        );
        return section('Map', true, this.mapList, this.facts, this.absent, buttons);
    }

    viewSection() {
        return section(
            'View',
            true,
            this.add(checkbox('textured', 'Textures', this.change)),
            this.add(
                choice(
                    'tint',
                    'Colors',
                    [
                        ['off', 'None'],
                        ['luxels', 'Luxel size'],
                        ['clusters', 'Clusters'],
                    ],
                    this.change,
                ),
            ),
            this.add(
                slider(
                    'brightness',
                    'Brightness',
                    { min: 0.25, max: 3, step: 0.05, digits: 2, unit: ' ×' },
                    this.change,
                ),
            ),
            this.add(slider('speed', 'Speed', { min: 40, max: 1600, step: 20, unit: ' units/s' }, this.change)),
        );
    }

    /** A slider for each light style; hidden if the map has style 0 only. */
    styleSection() {
        const all = (value) => () => {
            for (const { style } of this.viewer.styles) this.viewer.settings.styleLight[style] = value;
            this.viewer.changed();
            this.show();
        };
        this.styleRows = make('div');
        const buttons = make('div', { class: 'buttons' }, button('All on', all(1)), button('All off', all(0)));
        this.styles = section('Light styles', false, this.styleRows, buttons);
        this.styles.hidden = true;
        return this.styles;
    }

    /** Makes the sliders of a map's styles. */
    showStyles() {
        const { settings, styles } = this.viewer;
        this.styles.hidden = styles.length === 0;
        this.styleControls = [{ style: 0, names: ['always on'] }, ...styles].map(({ style, names }) => {
            const label = names.length > 0 ? `${style}: ${names.join(', ')}` : `${style}`;
            const change = (key, value) => {
                settings.styleLight[style] = value;
                this.viewer.changed();
                this.show();
            };
            const control = slider('light', label, { min: 0, max: 1, step: 0.05, digits: 2 }, change);
            return { row: control.row, show: () => control.show({ light: settings.styleLight[style] }) };
        });
        this.styleRows.replaceChildren(...this.styleControls.map(({ row }) => row));
        this.styleControls.forEach((control) => control.show());
    }

    pointSection() {
        const { change } = this;
        return section(
            'Light grid',
            true,
            this.add(checkbox('showPoints', 'Points as spheres', change)),
            this.add(
                choice(
                    'source',
                    'Grid',
                    [
                        ['uniform', 'SH'],
                        ['sparse', 'SH sparse'],
                        ['legacy', 'Legacy'],
                    ],
                    change,
                ),
            ),
            this.add(
                choice(
                    'color',
                    'Color',
                    [
                        ['light', 'Light'],
                        ['kind', 'Kind'],
                        ['level', 'Cell size'],
                    ],
                    change,
                ),
            ),
            this.add(
                choice(
                    'where',
                    'Where',
                    [
                        ['near', 'Near the viewer'],
                        ['slice', 'In the slice'],
                    ],
                    change,
                ),
            ),
            this.add(slider('radius', 'Radius', { min: 64, max: 2048, step: 32, unit: ' units' }, change)),
            this.add(slider('size', 'Sphere size', { min: 0.4, max: 3, step: 0.1, digits: 1, unit: ' ×' }, change)),
            this.add(checkbox('inWalls', 'Points in solid space too', change)),
            this.pointCount,
        );
    }

    figureSection() {
        return section(
            'Figure',
            false,
            this.add(
                choice(
                    'figure',
                    'Lit by',
                    [
                        ['off', 'Off'],
                        ['sh', 'SH'],
                        ['legacy', 'Legacy'],
                        ['both', 'Both'],
                    ],
                    this.change,
                ),
            ),
            this.add(checkbox('follow', 'Follows the viewer', this.change)),
            this.add(checkbox('minLight', 'Minimum light of the game (+32)', this.change)),
            this.values,
        );
    }

    sliceSection() {
        const { change } = this;
        return section(
            'Slice and errors',
            false,
            this.add(slider('height', 'Height', { min: -512, max: 512, step: 4, unit: ' units' }, change)),
            this.add(slider('thickness', 'Thickness', { min: 8, max: 512, step: 8, unit: ' units' }, change)),
            this.add(checkbox('cut', 'Cut the map above it', change)),
            make(
                'div',
                { class: 'buttons' },
                button('At eye level', () => change('height', Math.round(this.viewer.camera.position.z))),
            ),
            this.add(
                choice(
                    'errors',
                    'Measured error',
                    [
                        ['off', 'Off'],
                        ['sh', 'SH'],
                        ['legacy', 'Legacy'],
                    ],
                    change,
                ),
            ),
            this.add(slider('largest', 'End of the scale', { min: 1, max: 128, step: 1, unit: ' bytes' }, change)),
            this.errorCount,
        );
    }

    unexplainedSection() {
        return section(
            'Unexplained light',
            false,
            this.add(checkbox('unexplained', 'Luxels as dots', this.change)),
            this.add(
                slider('mostUnexplained', 'End of the scale', { min: 1, max: 128, step: 1, unit: ' bytes' }, this.change),
            ),
            this.unexplainedCount,
        );
    }

    partSection() {
        return section(
            'Parts of the map',
            false,
            this.add(checkbox('lights', 'Light entities', this.change)),
            this.add(checkbox('places', 'Explained places', this.change)),
            this.add(checkbox('leak', 'Leak line (.lin)', this.change)),
            this.add(checkbox('portals', 'Portals (.prt)', this.change)),
            this.add(checkbox('onlyVisible', 'Only what this cluster sees', this.change)),
        );
    }

    /** Brings all controls up to date; those without data are off. */
    show() {
        const { settings, grids, side, map, tree, errors, unexplained } = this.viewer;
        for (const control of [...this.controls, ...this.styleControls]) control.show(settings);
        const any = Boolean(grids.uniform || grids.sparse || grids.legacy);
        for (const name of ['showPoints', 'where', 'size', 'inWalls', 'radius', 'color']) this[name].enable(any);
        for (const name of ['uniform', 'sparse', 'legacy']) this.source.enableValue(name, Boolean(grids[name]));
        this.color.enableValue('level', settings.source === 'sparse' && any);
        this.figure.enableValue('sh', Boolean(grids.uniform || grids.sparse));
        this.figure.enableValue('legacy', Boolean(grids.legacy));
        this.figure.enableValue('both', any);
        for (const name of ['leak', 'portals', 'lights', 'places']) this[name].enable(Boolean(side[name]));
        const measured = Boolean(errors.errors);
        this.errors.enable(measured);
        this.errors.enableValue('legacy', Boolean(errors.errors?.legacy));
        this.largest.enable(measured && settings.errors !== 'off');
        this.unexplained.enable(Boolean(unexplained.light));
        this.mostUnexplained.enable(Boolean(unexplained.light) && settings.unexplained);
        this.tint.enable(Boolean(map));
        this.onlyVisible.enable(Boolean(map) && tree.clusterCount > 0);
        if (map) this.height.limit(Math.floor(map.models[0].mins[2]), Math.ceil(map.models[0].maxs[2]));
    }

    /** Maps to choose from, and the one that is shown. */
    showMaps(paths, shown) {
        this.mapList.hidden = paths.length < 2;
        this.mapList.replaceChildren(
            ...paths.map((path) => make('option', { value: path, selected: path === shown }, path)),
        );
    }

    showFacts() {
        const { map, grids, lightmaps, lightList, mesh, stats, textures } = this.viewer;
        const grid = (g) => (g ? `${number(g.count)} · ${vector(g.cell, 0)}` : 'none');
        const rows = [
            ['File', `${map.ident} ${map.version}, ${(map.bytes / 1e6).toFixed(1)} MB`],
            ['Surfaces', number(map.surfaces.length)],
            ['Triangles', number(mesh.triangles)],
            ['Lightmaps', String(lightmaps.count)],
            ['Light entities', number(lightList?.length ?? 0)],
            ['SH points · cell', grid(grids.uniform)],
            ['Sparse SH points · cell', grid(grids.sparse)],
            ['Legacy points · cell', grid(grids.legacy)],
        ];
        rows.push(['First picture', `${stats.firstPicture.toFixed(0)} ms`]);
        this.facts.replaceChildren(...rows.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)]));
        this.showAbsent([...textures.absent, ...lightmaps.missing].map(String).sort());
    }

    /** Names of images that no open file has; surfaces are gray there. */
    showAbsent(names) {
        this.absent.hidden = names.length === 0;
        const what = names.length === 1 ? '1 image not found' : `${number(names.length)} images not found`;
        this.absent.replaceChildren(
            make('summary', {}, what),
            make('p', { class: 'note' }, 'Open the archives that have them. Until then these surfaces are gray.'),
            make('ul', {}, ...names.map((name) => make('li', {}, name))),
        );
    }

    /** What changes from frame to frame. */
    showFrame() {
        const { gridLayer, errorSummary, unexplainedSummary, settings } = this.viewer;
        const { near, shown } = gridLayer.counts;
        const [lit, filled, dark] = gridLayer.kinds.map(number);
        const count = `${number(shown)} of ${number(near)} points in reach: ${lit} lit, ${filled} filled, ${dark} void`;
        this.pointCount.textContent = settings.showPoints && near > 0 ? count : '';
        const summary = (of, what) => (of ? `${number(of.count)} ${what}, RMS ${of.rms.toFixed(2)} bytes` : '');
        this.errorCount.textContent = summary(errorSummary, 'positions in the slice');
        this.unexplainedCount.textContent = summary(unexplainedSummary, 'luxels');
        this.values.hidden = settings.figure === 'off';
        if (settings.figure !== 'off') this.values.textContent = this.figureText();
        if (this.follow.row.firstChild.checked !== settings.follow) this.follow.show(settings);
    }

    figureText() {
        const { figure, figureLight, tree } = this.viewer;
        const origin = figure.origin.toArray();
        const mean = [0, 1, 2].map((c) => figureLight.coeffs[c] * 0.282094792 * 255);
        const cluster = tree.clusterAt(...origin);
        return [
            `light origin  ${vector(origin, 0)}`,
            `cluster       ${cluster < 0 ? 'solid' : cluster}`,
            `SH mean       ${vector(mean, 1)}`,
            `ambient       ${vector(figureLight.legacy.ambient, 1)}`,
            `directed      ${vector(figureLight.legacy.directed, 1)}`,
            `direction     ${vector(figureLight.legacy.direction, 2)}`,
        ].join('\n');
    }
}
