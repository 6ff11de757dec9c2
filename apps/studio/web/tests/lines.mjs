// No source of the page is longer than 400 lines.
import { readFileSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const kMost = 400;
const web = join(dirname(fileURLToPath(import.meta.url)), "..");
const long = ["src", "tests"].flatMap((folder) =>
  readdirSync(join(web, folder), { recursive: true })
    .filter((name) => /\.(ts|mjs|css|html)$/.test(name))
    .map((name) => ({ name: join(folder, name), lines: readFileSync(join(web, folder, name), "utf8").split("\n").length - 1 }))
    .filter(({ lines }) => lines > kMost),
);
for (const { name, lines } of long) console.error(`${name}: ${lines} lines, more than ${kMost}`);
process.exit(long.length > 0 ? 1 : 0);
