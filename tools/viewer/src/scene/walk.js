// GPL-2.0-or-later. Moving through the map: keys, mouse, one or two fingers, and the pad on the screen.
import * as THREE from 'three';

const kTurnPerPixel = 0.0035; // radians
const kTurnPerSecond = 1.8; // radians, by keys
const kFingerUnits = 1.6; // units a pixel of two fingers
const kClickPixels = 4; // a pointer that moves less between press and release has clicked
const kSteepest = Math.PI / 2; // of pitch

const kMoves = {
    KeyW: [1, 0, 0],
    KeyS: [-1, 0, 0],
    KeyD: [0, 1, 0],
    KeyA: [0, -1, 0],
    KeyE: [0, 0, 1],
    Space: [0, 0, 1],
    KeyQ: [0, 0, -1],
    KeyC: [0, 0, -1],
};
const kTurns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Walk {
    yaw = 0;
    pitch = 0;
    /** Units a second. */
    speed = 320;
    /** Of the pad: forward, right, up, each -1 to 1. */
    pad = [0, 0, 0];
    keys = new Set();
    /** Whether Shift is pressed: three times the speed. */
    fast = false;
    /** Positions of pressed pointers by their id. */
    pointers = new Map();

    /**
     * @param {THREE.PerspectiveCamera} camera
     * @param {HTMLElement} element gets the events
     * @param owner functions: `changed()`; `grab(event)`, whether a pressed pointer takes hold of something instead of
     *   turning the view; `drag(event)`, called when that pointer moves; `click(event)`
     */
    constructor(camera, element, owner) {
        this.camera = camera;
        this.element = element;
        this.owner = owner;
        element.addEventListener('keydown', (event) => this.onKey(event));
        element.addEventListener('keyup', (event) => {
            this.keys.delete(event.code);
            this.fast = event.shiftKey;
        });
        element.addEventListener('blur', () => this.keys.clear());
        element.addEventListener('pointerdown', (event) => this.onDown(event));
        element.addEventListener('pointermove', (event) => this.onMove(event));
        for (const name of ['pointerup', 'pointercancel']) element.addEventListener(name, (event) => this.onUp(event));
        element.addEventListener('dblclick', () => this.lock());
        element.addEventListener('wheel', (event) => this.onWheel(event), { passive: false });
    }

    get locked() {
        return document.pointerLockElement === this.element;
    }

    /** The mouse turns the view without a button until Escape, where the browser allows it. */
    lock() {
        this.element.focus();
        this.element.requestPointerLock?.()?.catch?.(() => {});
    }

    onKey(event) {
        this.fast = event.shiftKey;
        if (event.ctrlKey || event.metaKey || event.altKey || !(event.code in kMoves || event.code in kTurns)) return;
        event.preventDefault();
        this.keys.add(event.code);
        this.owner.changed();
    }

    onDown(event) {
        this.element.focus({ preventScroll: true });
        if (event.button > 0) return;
        this.grabbed = this.pointers.size === 0 && this.owner.grab(event);
        this.pressedAt = this.pointers.size === 0 && !this.grabbed ? [event.clientX, event.clientY] : null;
        this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
        this.element.setPointerCapture?.(event.pointerId);
    }

    onMove(event) {
        const last = this.pointers.get(event.pointerId);
        if (this.locked) this.turn(-event.movementX * kTurnPerPixel, -event.movementY * kTurnPerPixel);
        if (!last) return;
        const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
        if (this.grabbed) this.owner.drag(event);
        else if (this.pointers.size === 1 && !this.locked) this.turn(-dx * kTurnPerPixel, -dy * kTurnPerPixel);
        else this.moveByFingers(event, last, dx, dy);
        this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
        this.owner.changed();
    }

    /** Two fingers: apart is forward, together back; aside and up move that way. */
    moveByFingers(event, last, dx, dy) {
        const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
        const distance = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        const spread = distance([event.clientX, event.clientY]) - distance(last);
        this.move([kFingerUnits * spread, (-kFingerUnits * dx) / 2, (kFingerUnits * dy) / 2]);
    }

    onUp(event) {
        const pressed = this.pointers.has(event.pointerId) && this.pointers.size === 1 ? this.pressedAt : null;
        const moved = pressed ? Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) : Infinity;
        if (event.type === 'pointerup' && moved < kClickPixels && !this.locked) this.owner.click(event);
        this.pointers.delete(event.pointerId);
        if (this.pointers.size === 0) this.grabbed = false;
    }

    onWheel(event) {
        event.preventDefault();
        this.move([-event.deltaY * (event.deltaMode === 1 ? 16 : 0.6), 0, 0]);
        this.owner.changed();
    }

    /** Changes yaw and pitch, radians. */
    turn(yaw, pitch) {
        this.yaw += yaw;
        this.pitch = Math.min(Math.max(this.pitch + pitch, -kSteepest), kSteepest);
        this.owner.changed();
    }

    forward() {
        return new THREE.Vector3(
            Math.cos(this.yaw) * Math.cos(this.pitch),
            Math.sin(this.yaw) * Math.cos(this.pitch),
            Math.sin(this.pitch),
        );
    }

    right() {
        return new THREE.Vector3(Math.sin(this.yaw), -Math.cos(this.yaw), 0);
    }

    /** Moves by units forward, right and up. */
    move([forward, right, up]) {
        this.camera.position.addScaledVector(this.forward(), forward).addScaledVector(this.right(), right);
        this.camera.position.z += up;
    }

    /**
     * Moves and turns by the keys and the pad for a time.
     * @returns {boolean} whether one of them is pressed
     */
    step(seconds) {
        const sum = [...this.pad];
        const turn = [0, 0];
        for (const code of this.keys) {
            kMoves[code]?.forEach((n, i) => (sum[i] += n));
            kTurns[code]?.forEach((n, i) => (turn[i] += n));
        }
        const length = Math.max(1, Math.hypot(...sum));
        const units = (this.speed * (this.fast ? 3 : 1) * seconds) / length;
        this.move(sum.map((n) => n * units));
        this.turnByKeys(turn, seconds);
        return this.keys.size > 0 || sum.some((n) => n !== 0);
    }

    turnByKeys([yaw, pitch], seconds) {
        if (yaw !== 0 || pitch !== 0) this.turn(yaw * kTurnPerSecond * seconds, pitch * kTurnPerSecond * seconds);
    }

    apply() {
        this.camera.rotation.set(this.pitch + Math.PI / 2, 0, this.yaw - Math.PI / 2, 'ZXY'); // +x, up z
        this.camera.updateMatrixWorld();
    }
}
