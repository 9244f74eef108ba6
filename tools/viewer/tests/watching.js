// GPL-2.0-or-later. Runs q3map2 -watch beside a test.
import { spawn } from 'node:child_process';

/**
 * Starts -watch and waits for the address of its page.
 * @param {string} program
 * @param {string[]} options before -watch
 * @param {string} map
 * @returns {Promise<{address: string, text: () => string, end: () => Promise<number>}>} end: as by Ctrl-C, gives the exit
 *   status
 */
export function startWatch(program, options, map) {
    const child = spawn(program, [...options, '-watch', map], { stdio: ['ignore', 'pipe', 'inherit'] });
    const ended = new Promise((resolve) => child.on('exit', (status) => resolve(status ?? -1)));
    let text = '';
    return new Promise((resolve, reject) => {
        child.stdout.on('data', (bytes) => {
            text += bytes;
            const address = text.match(/The page: (\S+)\n/)?.[1];
            const end = () => {
                child.kill('SIGINT');
                return ended;
            };
            if (address) resolve({ address, text: () => text, end });
        });
        ended.then(() => reject(new Error(`-watch has ended: ${text}`)));
    });
}
