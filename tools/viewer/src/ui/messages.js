// GPL-2.0-or-later. Messages to the visitor: errors and remarks, each until it is dismissed.
import { make } from './controls.js';

export class Messages {
    constructor(element) {
        this.element = element;
    }

    /** @param {'error'|'note'} kind */
    add(kind, text) {
        const close = make('button', { type: 'button', 'aria-label': 'Dismiss', click: () => message.remove() }, '×');
        const message = make(
            'div',
            { class: `message ${kind}`, role: kind === 'error' ? 'alert' : 'status' },
            make('span', {}, text),
            close,
        );
        this.element.append(message);
    }

    clear() {
        this.element.replaceChildren();
    }
}
