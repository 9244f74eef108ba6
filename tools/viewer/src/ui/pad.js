// GPL-2.0-or-later. The pad for touch screens: a stick that moves, and buttons up and down.

const kReach = 44; // pixels from the middle of the stick to its rim

/** @param {import('../scene/walk.js').Walk} walk */
export function connectPad(element, walk, changed) {
    const stick = element.querySelector('.stick');
    const knob = stick.firstElementChild;
    const set = (x, y) => {
        walk.pad[0] = -y;
        walk.pad[1] = x;
        knob.style.transform = `translate(${x * kReach}px, ${y * kReach}px)`;
        changed();
    };
    stick.addEventListener('pointerdown', (event) => stick.setPointerCapture(event.pointerId));
    for (const name of ['pointerdown', 'pointermove'])
        stick.addEventListener(name, (event) => {
            if (!stick.hasPointerCapture(event.pointerId)) return;
            const box = stick.getBoundingClientRect();
            const [x, y] = [
                (event.clientX - box.left - box.width / 2) / kReach,
                (event.clientY - box.top - box.height / 2) / kReach,
            ];
            const length = Math.max(1, Math.hypot(x, y));
            set(x / length, y / length);
        });
    for (const name of ['pointerup', 'pointercancel']) stick.addEventListener(name, () => set(0, 0));
    for (const [selector, direction] of [
        ['.up', 1],
        ['.down', -1],
    ]) {
        const key = element.querySelector(selector);
        const press = (amount) => () => {
            walk.pad[2] = amount;
            changed();
        };
        key.addEventListener('pointerdown', press(direction));
        for (const name of ['pointerup', 'pointercancel', 'pointerleave']) key.addEventListener(name, press(0));
    }
}
