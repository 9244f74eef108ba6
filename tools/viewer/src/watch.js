// GPL-2.0-or-later. A page that q3map2 -watch serves: it follows the builds of a map over a WebSocket.
import { FormatError } from './bsp/bytes.js';

/** The map that the page follows, such as maps/x.bsp; null: the page is not served by -watch. */
export function watchedMap(page) {
    return page.getElementById('watch')?.dataset.map.toLowerCase() ?? null;
}

/** @returns {Promise<Blob>} a file of the server */
async function download(name) {
    const response = await fetch(name, { cache: 'no-store' });
    if (!response.ok) throw new FormatError(`${name}: the watch answers ${response.status}.`);
    return response.blob();
}

/** Entities of lights.json, as readMap gives them. */
async function readLights(blob) {
    return JSON.parse(await blob.text()).map((keys) => new Map(Object.entries(keys)));
}

export class Watch {
    /** What the server told last; null: nothing yet. */
    state = null;
    ended = false;
    /** Version of the map on the screen, and the digest of its resources. */
    shown = 0;
    resources = '';
    /** When its state arrived and when it was drawn, from performance.now(). */
    arrived = 0;
    drawn = 0;
    busy = false;

    /**
     * @param {string} map from watchedMap
     * @param {import('./opener.js').Opener} opener
     * @param {() => void} changed called after each change of the members
     */
    constructor(map, opener, changed) {
        this.map = map;
        this.opener = opener;
        this.changed = changed;
    }

    connect() {
        const address = new URL('socket', location.href);
        address.protocol = 'ws:';
        address.hash = '';
        const socket = new WebSocket(address);
        socket.addEventListener('message', (event) => this.hear(JSON.parse(event.data)));
        socket.addEventListener('close', () => {
            this.ended = true;
            this.changed();
        });
    }

    hear(state) {
        const leak = JSON.stringify(this.state?.leak ?? []);
        this.state = state;
        if (JSON.stringify(state.leak) !== leak) this.showLeak();
        this.changed();
        this.follow();
    }

    showLeak() {
        const { viewer } = this.opener;
        if (viewer.map) viewer.setLeak(this.state.leak.length > 1 ? this.state.leak : null);
    }

    /** Shows the newest version, and again while newer ones arrive. */
    async follow() {
        if (this.busy) return;
        this.busy = true;
        while (this.state.version !== this.shown && !this.ended) {
            const { version, resources } = this.state;
            this.arrived = performance.now();
            try {
                await this.load(version, resources);
            } catch (error) {
                this.opener.report(error, this.map);
            }
            this.shown = version;
            this.changed();
        }
        this.busy = false;
    }

    async load(version, resources) {
        const isNew = resources !== this.resources;
        const [bsp, lights, archive] = await Promise.all([
            download(`map.bsp?${version}`),
            download(`lights.json?${version}`).then(readLights),
            isNew && resources !== '' ? download(`resources.pk3?${resources}`) : null,
        ]);
        const { opener } = this;
        opener.viewer.givenLights = lights;
        opener.viewer.shownFirst = () => {
            this.drawn = performance.now();
        };
        await opener.update(this.map, bsp, archive && { path: 'resources.pk3', blob: archive });
        this.resources = resources;
        this.showLeak();
    }
}
