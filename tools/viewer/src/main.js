// GPL-2.0-or-later. Puts the page together.
import { droppedFiles, embeddedPackage } from './files/opened.js';
import { Opener } from './opener.js';
import { showLegend } from './ui/legend.js';
import { Messages } from './ui/messages.js';
import { connectPad } from './ui/pad.js';
import { Panel } from './ui/panel.js';
import { placeOf } from './place_link.js';
import { showSurface } from './ui/surface_box.js';
import { WatchPanel } from './ui/watch_panel.js';
import { Viewer } from './viewer.js';
import { Watch, watchedMap } from './watch.js';

const element = (id) => document.getElementById(id);
const kFigureStep = 8; // units a key press
const kFigureKeys = {
    KeyI: [1, 0, 0],
    KeyK: [-1, 0, 0],
    KeyL: [0, 1, 0],
    KeyJ: [0, -1, 0],
    KeyU: [0, 0, 1],
    KeyO: [0, 0, -1],
};

function showStatus(viewer) {
    const { stats, camera } = viewer;
    const at = camera.position
        .toArray()
        .map((c) => c.toFixed(0))
        .join(' ');
    const fps = stats.fps > 0 ? `${stats.fps.toFixed(0)} fps · ` : '';
    element('status').textContent =
        `${fps}${stats.calls} draw calls · first picture ${stats.firstPicture.toFixed(0)} ms · ${at}`;
}

function setPanel(open) {
    element('panel').hidden = !open;
    element('toggle').setAttribute('aria-expanded', String(open));
    document.body.classList.toggle('panelOpen', open);
}

function setKeys(shown) {
    element('keys').hidden = !shown;
    element('help').setAttribute('aria-expanded', String(shown));
}

/** Puts the place into the address of the page and, where the browser allows it, into the clipboard. */
async function copyLink(viewer, messages) {
    history.replaceState(null, '', viewer.link());
    try {
        await navigator.clipboard.writeText(location.href);
        messages.add('note', 'The link to this place is in the clipboard.');
    } catch {
        messages.add('note', "The address of the page now leads to this place: copy it from the browser's address bar.");
    }
}

async function savePicture(viewer) {
    const address = URL.createObjectURL(await viewer.picture());
    const anchor = document.createElement('a');
    const place = viewer.camera.position.toArray().map((c) => c.toFixed(0));
    anchor.href = address;
    anchor.download = `${viewer.path.split('/').pop().replace(/\.bsp$/i, '')}_${place.join('_')}.png`;
    anchor.click();
    URL.revokeObjectURL(address);
}

function followLinks(viewer) {
    addEventListener('hashchange', () => {
        const place = viewer.map && placeOf(location.hash, viewer.path);
        if (!place) return;
        viewer.toPlace(place);
        viewer.invalidate();
    });
}

function onKey(event, viewer, panel) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.code in kFigureKeys) viewer.moveFigure(...kFigureKeys[event.code].map((n) => kFigureStep * n));
    else if (event.code === 'Home' && viewer.map) viewer.toStart();
    else if (event.code === 'End' && viewer.map) panel.fromAbove();
    else if (event.code === 'Escape') viewer.pick(null);
    else return;
    event.preventDefault();
}

function connectDrops(opener) {
    const hint = element('dropHint');
    addEventListener('dragover', (event) => {
        event.preventDefault();
        hint.hidden = false;
    });
    addEventListener('dragleave', (event) => {
        if (!event.relatedTarget) hint.hidden = true;
    });
    addEventListener('drop', async (event) => {
        event.preventDefault();
        hint.hidden = true;
        await opener.add(await droppedFiles(event.dataTransfer));
    });
}

function connectChooser(opener) {
    const chooser = element('chooser');
    for (const id of ['open', 'openStart']) element(id).addEventListener('click', () => chooser.click());
    chooser.addEventListener('change', async () => {
        const given = [...chooser.files].map((file) => ({ path: file.name, blob: file }));
        chooser.value = '';
        await opener.add(given);
    });
}

/** Follows the builds of a map. */
function startWatch(map, opener, viewer) {
    let panel = null;
    const watch = new Watch(map, opener, () => panel.show());
    panel = new WatchPanel(element('watch'), watch, (place) => {
        if (viewer.map) viewer.lookAt(place);
    });
    element('start').hidden = true;
    viewer.settings.lights = true;
    panel.show();
    watch.connect();
    return watch;
}

async function openEmbedded(opener) {
    try {
        const embedded = embeddedPackage(document);
        if (embedded) await opener.add([embedded], embedded.map);
    } catch (error) {
        opener.report(error);
    }
}

function start() {
    const messages = new Messages(element('messages'));
    let panel = null;
    let viewer;
    try {
        viewer = new Viewer(element('view'), () => {
            if (!viewer?.map) return;
            showStatus(viewer);
            panel?.showFrame();
            showLegend(element('legend'), viewer);
            showSurface(element('surface'), viewer, () => viewer.pick(null));
        });
    } catch (error) {
        messages.add('error', `This browser does not show 3D pictures (WebGL 2): ${error.message}`);
        return;
    }
    const opener = new Opener(viewer, messages, (paths, shown) => {
        if (element('status').hidden) {
            setPanel(matchMedia('(min-width: 700px)').matches);
            setKeys(true);
            element('pad').hidden = !matchMedia('(pointer: coarse)').matches;
        }
        for (const id of ['open', 'help', 'toggle']) element(id).hidden = false;
        element('start').hidden = true;
        element('status').hidden = false;
        element('title').textContent = shown;
        document.title = `${shown} – light grid viewer`;
        panel.showStyles();
        panel.show();
        panel.showMaps(paths, shown);
        panel.showFacts();
        if (!watchedMap(document)) element('view').focus({ preventScroll: true });
    });
    panel = new Panel(element('panel'), viewer, {
        chooseMap: (path) => opener.show(path).catch((error) => opener.report(error, path)),
        copyLink: () => copyLink(viewer, messages),
        savePicture: () => savePicture(viewer).catch((error) => opener.report(error)),
    });
    element('toggle').addEventListener('click', () => setPanel(element('panel').hidden));
    element('help').addEventListener('click', () => setKeys(element('keys').hidden));
    element('keys').querySelector('button').addEventListener('click', () => setKeys(false));
    followLinks(viewer);
    element('view').addEventListener('keydown', (event) => onKey(event, viewer, panel));
    connectPad(element('pad'), viewer.walk, () => viewer.invalidate());
    connectDrops(opener);
    connectChooser(opener);
    const watched = watchedMap(document);
    const watch = watched && startWatch(watched, opener, viewer);
    window.viewer = { viewer, opener, panel, watch }; // for tests; tools/viewer/README.md says what they use
    openEmbedded(opener);
}

start();
