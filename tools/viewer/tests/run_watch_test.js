// GPL-2.0-or-later. Runs watch.test.js for CTest. Exit status 77: without playwright-core, which npm ci installs, or
// without Chromium there is nothing to test with.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

const tests = import.meta.dirname;
const browser = process.env.CHROMIUM ?? '/usr/bin/chromium';
if (!existsSync(join(tests, '../node_modules/playwright-core')) || !existsSync(browser)) {
    console.log(`skipped: needs ${browser}, and npm ci in tools/viewer`);
    process.exit(77);
}
process.exit(spawnSync(process.execPath, ['--test', join(tests, 'watch.test.js')], { stdio: 'inherit' }).status ?? 1);
