// GPL-2.0-or-later. A place in a map as the part of the page's address after '#': #map=maps/x.bsp&at=X,Y,Z,YAW,PITCH.

const kDegrees = 180 / Math.PI;

/** @returns {string} with yaw and pitch in degrees */
export function linkTo(path, [x, y, z], yaw, pitch) {
    const numbers = [x, y, z, yaw * kDegrees, pitch * kDegrees].map((n) => Number(n.toFixed(1)) + 0);
    return `#map=${encodeURIComponent(path).replaceAll('%2F', '/')}&at=${numbers.join(',')}`;
}

/** The place that an address names; null if it names none, or one of another map. */
export function placeOf(hash, path) {
    const parts = new URLSearchParams(hash.replace(/^#/, ''));
    const numbers = (parts.get('at') ?? '').split(',').map((text) => (text.trim() === '' ? NaN : Number(text)));
    const fileName = (name) => name.toLowerCase().split('/').pop();
    if (numbers.length !== 5 || !numbers.every(Number.isFinite)) return null;
    if (parts.get('map') && fileName(parts.get('map')) !== fileName(path)) return null;
    const [x, y, z, yaw, pitch] = numbers;
    return { position: [x, y, z], yaw: yaw / kDegrees, pitch: Math.min(Math.max(pitch, -90), 90) / kDegrees };
}
