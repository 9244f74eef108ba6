// GPL-2.0-or-later. What the builds of a watched map do and complain about.
import { make } from './controls.js';

const kPasses = [
    ['draft', 'Draft'],
    ['final', 'Final'],
];

const kLeak = 'MAP LEAKED'; // the message that has the line

function stageText({ name, state, seconds }) {
    if (state === 'running') return `${name} …`;
    return `${name} ${seconds.toFixed(1)} s${state === 'failed' ? ' failed' : ''}`;
}

/** What is going on, in a few words. */
function headline({ state, ended, shown }) {
    if (ended) return 'The watch has ended';
    if (!state) return 'Connecting…';
    if (state.gone) return `${state.source} is gone`;
    if (state.stages.some((stage) => stage.state === 'failed')) return 'The build failed';
    if (state.leak.length > 0 && !state.running) return 'The map leaks';
    if (state.running) return shown === state.version && state.stages.at(-1)?.pass === 'final' ? 'Refining' : 'Building';
    return 'Up to date';
}

export class WatchPanel {
    /** Point of the leak line that the next click goes to. */
    leakStep = 0;

    /**
     * @param {HTMLElement} element
     * @param {import('../watch.js').Watch} watch
     * @param {(place: number[]) => void} goTo brings the camera there
     */
    constructor(element, watch, goTo) {
        this.element = element;
        this.watch = watch;
        this.goTo = goTo;
        this.head = make('div', { class: 'head', role: 'status' });
        this.passes = make('div', { class: 'passes' });
        this.list = make('ul', { 'aria-label': 'Warnings and errors' });
        element.append(this.head, this.passes, this.list);
        element.hidden = false;
    }

    show() {
        const { state, ended } = this.watch;
        this.head.textContent = headline(this.watch);
        const isBad = ended || state?.leak.length > 0 || state?.stages.some((stage) => stage.state === 'failed');
        this.head.classList.toggle('failed', Boolean(isBad));
        if (!state) return;
        this.passes.replaceChildren(
            ...kPasses.flatMap(([pass, label]) => {
                const stages = state.stages.filter((stage) => stage.pass === pass);
                return stages.length > 0 ? [make('div', {}, `${label}: ${stages.map(stageText).join(' · ')}`)] : [];
            }),
        );
        this.showList(state);
    }

    showList({ messages, leak, save }) {
        const key = JSON.stringify([messages, leak, save]);
        if (key === this.listKey) return; // keeps the focus
        this.listKey = key;
        this.leakStep = 0;
        const followLeak = () => this.goTo(leak[leak.length - 1 - (this.leakStep++ % leak.length)]);
        this.list.replaceChildren(
            ...messages.map(({ level, stage, text, at }) =>
                text === kLeak && leak.length > 1
                    ? this.row(level, stage, `${text}: each click goes one point along the red line`, followLeak)
                    : this.row(level, stage, text, at && (() => this.goTo(at))),
            ),
        );
    }

    row(level, stage, text, press) {
        const content = [make('b', {}, stage), ` ${text}`];
        return make(
            'li',
            { class: level },
            press ? make('button', { type: 'button', title: 'Go there', click: press }, ...content) : make('span', {}, ...content),
        );
    }
}
