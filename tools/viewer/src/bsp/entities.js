// GPL-2.0-or-later. Entity text of maps: key and value pairs in braces.

/**
 * Parses as far as the text is well formed. Of two equal keys of an entity the first counts, as in the game.
 * @param {string} text
 * @returns {Map<string, string>[]} keys are lower case
 */
export function parseEntities(text) {
    const entities = [];
    const token = /"([^"]*)"|[{}]|[^\s"{}]+/g;
    let entity = null;
    let key = null;
    for (let match; (match = token.exec(text));) {
        const word = match[1] ?? match[0];
        if (match[0] === '{') {
            entity = new Map();
            key = null;
        } else if (match[0] === '}') {
            if (entity) entities.push(entity);
            entity = null;
        } else if (!entity) {
            break;
        } else if (key === null) {
            key = word.toLowerCase();
        } else {
            if (!entity.has(key)) entity.set(key, word);
            key = null;
        }
    }
    return entities;
}

/** Three numbers of a value such as "64 0 -8"; null if there are no three. */
export function parseVector(value) {
    const numbers = (value ?? '').trim().split(/\s+/).map(Number);
    return numbers.length >= 3 && numbers.slice(0, 3).every(Number.isFinite) ? numbers.slice(0, 3) : null;
}

/** Light entities: position, color with largest channel 1, brightness. */
export function lightEntities(entities) {
    return entities
        .filter((entity) => /^light/.test(entity.get('classname') ?? ''))
        .flatMap((entity) => {
            const origin = parseVector(entity.get('origin'));
            if (!origin) return [];
            const color = parseVector(entity.get('_color')) ?? [1, 1, 1];
            const most = Math.max(...color);
            const light = Number.parseFloat(entity.get('light') ?? entity.get('_light') ?? '300');
            return [
                {
                    classname: entity.get('classname'),
                    origin,
                    color: most > 0 ? color.map((c) => Math.max(c, 0) / most) : [1, 1, 1],
                    brightness: Number.isFinite(light) ? light : 300,
                },
            ];
        });
}

/** Names by which the game switches lights of a style. */
export function namesOfStyle(entities, style) {
    const lights = entities.filter(
        (entity) => /^light/.test(entity.get('classname') ?? '') && Number(entity.get('style') ?? NaN) === style,
    );
    return [...new Set(lights.map((light) => light.get('targetname') ?? '').filter((name) => name !== ''))];
}

/** A place to start from: position of the eyes, yaw in degrees. */
export function startPosition(entities) {
    for (const wanted of [
        /^info_player_start$/,
        /^info_player_deathmatch$/,
        /^info_player/,
        /^team_ctf_.*(player|spawn)/,
    ])
        for (const entity of entities) {
            const origin = wanted.test(entity.get('classname') ?? '') && parseVector(entity.get('origin'));
            if (!origin) continue;
            const yaw = Number.parseFloat(entity.get('angle') ?? entity.get('angles')?.split(/\s+/)[1] ?? '0');
            return { position: [origin[0], origin[1], origin[2] + 26], yaw: Number.isFinite(yaw) ? yaw : 0 };
        }
    return null;
}
