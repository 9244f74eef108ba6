// GPL-2.0-or-later. Small pieces of the panel: each shows a setting and changes it.

let nextId = 0;

/** An element with attributes (functions are listeners) and children. */
export function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes))
        if (typeof value === 'function') element.addEventListener(name, value);
        else if (value === true) element.setAttribute(name, '');
        else if (value !== false && value !== undefined) element.setAttribute(name, value);
    element.append(...children);
    return element;
}

/**
 * A control: its row, `show(settings)` to bring it up to date, and `enable(on)`.
 * @typedef {{row: HTMLElement, key: string, show: (settings: object) => void, enable: (on: boolean) => void}} Control
 */

/** @returns {Control} */
export function checkbox(key, label, change) {
    const input = make('input', { type: 'checkbox', name: key, change: () => change(key, input.checked) });
    const row = make('label', { class: 'row check' }, input, make('span', {}, label));
    return control(
        row,
        key,
        (settings) => {
            input.checked = settings[key];
        },
        [input],
    );
}

/** @returns {Control} */
export function slider(key, label, { min, max, step, unit = '', digits = 0 }, change) {
    const id = `control${nextId++}`;
    const output = make('output', { for: id });
    const input = make('input', {
        type: 'range',
        id,
        name: key,
        min,
        max,
        step,
        input: () => change(key, Number(input.value)),
    });
    const row = make('div', { class: 'row slide' }, make('label', { for: id }, label), output, input);
    const show = (settings) => {
        if (Number(input.value) !== settings[key]) input.value = settings[key];
        output.textContent = `${settings[key].toFixed(digits)}${unit}`;
    };
    const made = control(row, key, show, [input]);
    made.limit = (low, high) => {
        input.min = low;
        input.max = high;
    };
    return made;
}

/**
 * One of a few choices, side by side.
 * @param {[string, string][]} options value and label
 * @returns {Control}
 */
export function choice(key, label, options, change) {
    const inputs = options.map(([value, text]) => {
        const input = make('input', { type: 'radio', name: key, value, change: () => change(key, value) });
        return { input, value, element: make('label', {}, input, make('span', {}, text)) };
    });
    const row = make(
        'fieldset',
        { class: 'row choice' },
        make('legend', {}, label),
        make('div', {}, ...inputs.map((i) => i.element)),
    );
    const made = control(
        row,
        key,
        (settings) =>
            inputs.forEach((i) => {
                i.input.checked = settings[key] === i.value;
            }),
        inputs.map((i) => i.input),
    );
    made.enableValue = (value, on) => {
        const found = inputs.find((i) => i.value === value);
        found.input.disabled = !on;
        found.element.classList.toggle('off', !on);
    };
    return made;
}

function control(row, key, show, inputs) {
    return {
        row,
        key,
        show,
        enable(on) {
            row.classList.toggle('off', !on);
            for (const input of inputs) input.disabled = !on;
        },
    };
}

export function button(label, press, title = label, className = undefined) {
    return make('button', { type: 'button', title, class: className, click: press }, label);
}

/** A part of the panel that opens and closes. */
export function section(title, open, ...children) {
    return make('details', { open }, make('summary', {}, title), make('div', { class: 'body' }, ...children));
}
