// GPL-2.0-or-later. What a visitor can set, with the initial values.
import { onlyStyle0 } from './bsp/grid_styled.js';

export function initialSettings() {
    return {
        textured: true,
        brightness: 1, // factor on all light
        styleLight: onlyStyle0(), // brightness by light style, 0 to 1
        speed: 320, // units a second; that of players
        showPoints: false,
        source: 'uniform', // 'uniform', 'sparse' or 'legacy': the grid that points and the SH figure show
        color: 'light', // 'light', 'kind' or 'level'
        where: 'near', // 'near' or 'slice'
        radius: 320, // units from the viewer
        size: 1, // factor on the spheres
        inWalls: true, // points in solid space too
        figure: 'off', // 'off', 'sh', 'legacy' or 'both'
        follow: true, // the figure stays before the viewer
        minLight: false, // what the game adds to things that move
        height: 0, // of the slice, units
        thickness: 64,
        cut: false, // hides the map above the slice
        errors: 'off', // 'off', 'sh' or 'legacy'
        largest: 10, // end of the scale of errors, displayed bytes
        unexplained: false, // luxels with light that no lamp explains
        mostUnexplained: 10, // end of the scale of that light, bytes
        leak: true,
        portals: false,
        lights: false,
        places: false, // dots where the light is explained
        tint: 'off', // 'off', 'clusters' or 'luxels': colors in place of textures
        onlyVisible: false, // clusters that the viewer's sees
    };
}
