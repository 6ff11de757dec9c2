// The npm packages of the page's own lock file, for tests that lie outside of its folder.
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const page = fileURLToPath(new URL('../../../apps/studio/web/package.json', import.meta.url));
export const require = createRequire(page);
