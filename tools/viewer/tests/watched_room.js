// GPL-2.0-or-later. The source of a small map, for tests of -watch.

function box([a, b, c], [d, e, f]) {
    const planes = [
        [[a, b, f], [a, e, f], [d, b, f]],
        [[a, b, c], [d, b, c], [a, e, c]],
        [[d, b, c], [d, b, f], [d, e, c]],
        [[a, b, c], [a, e, c], [a, b, f]],
        [[a, e, c], [d, e, c], [a, e, f]],
        [[a, b, c], [a, b, f], [d, b, c]],
    ];
    const point = (p) => `( ${p.join(' ')} )`;
    const sides = planes.map((points) => `${points.map(point).join(' ')} t/wall 0 0 0 0.5 0.5 0 0 0`);
    return `{\n${sides.join('\n')}\n}\n`;
}

/**
 * A room of 384 x 384 x 128 units, with a light and a player.
 * @param {{lamp?: number[], hole?: boolean}} options hole: without its wall at positive x
 */
export function roomSource({ lamp = [100, 0, 64], hole = false }) {
    const [half, high, thick] = [192, 128, 16];
    const walls = [
        box([-half, -half, -thick], [half, half, 0]),
        box([-half, -half, high], [half, half, high + thick]),
        box([-half - thick, -half, 0], [-half, half, high]),
        box([-half, -half - thick, 0], [half, -half, high]),
        box([-half, half, 0], [half, half + thick, high]),
        hole ? '' : box([half, -half, 0], [half + thick, half, high]),
    ];
    return (
        `{\n"classname" "worldspawn"\n${walls.join('')}}\n` +
        `{\n"classname" "light"\n"origin" "${lamp.join(' ')}"\n"light" "200"\n}\n` +
        '{\n"classname" "info_player_deathmatch"\n"origin" "0 0 32"\n}\n'
    );
}
