// SPDX-License-Identifier: Apache-2.0
// Bundles src/: page.js and page.css for runs, report.js and report.css for studies and replayed flights. Also copies
// page.html and collects the licences of the bundled packages.
//
// Usage: node bundle.mjs OUT_DIR
import { build } from "esbuild";
import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2];
if (!out) throw new Error("usage: node bundle.mjs OUT_DIR");
mkdirSync(out, { recursive: true });

const common = { absWorkingDir: here, outdir: out, bundle: true, minify: true, charset: "utf8", metafile: true, logLevel: "warning" };
const scripts = await build({
  ...common,
  entryPoints: { page: "src/main.ts", report: "src/report/main.ts" },
  format: "iife",
  target: "es2022",
  legalComments: "none", // their licences are in LICENSES.txt
});
// Bundles the style sheets after the scripts, so that page.css replaces the page.css that esbuild writes for the
// packages that the scripts import.
const styles = await build({ ...common, entryPoints: { page: "src/page.css", report: "src/report/report.css" } });
copyFileSync(join(here, "page.html"), join(out, "page.html"));

const packages = new Set();
for (const file of [scripts, styles].flatMap(({ metafile }) => Object.keys(metafile.inputs))) {
  const found = /^node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file);
  if (found) packages.add(found[1]);
}
const parts = [];  // for the bill of materials, modeldesc/src/pack_fmu.hpp
const texts = [...packages].sort().map((name) => {
  const folder = join(here, "node_modules", name);
  const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const file = ["LICENSE", "LICENSE.md", "LICENSE.txt", "LICENCE"].map((each) => join(folder, each)).find(existsSync);
  if (!file) throw new Error(`${name} ships no licence text`);
  parts.push(`linked|${name}|${version}|${license}|pkg:npm/${name.replace("@", "%40")}@${version}|\n`);
  return `${name} ${version} (${license})\n\n${readFileSync(file, "utf8").trim()}\n`;
});
writeFileSync(join(out, "parts.txt"), parts.join(""));
writeFileSync(join(out, "LICENSES.txt"), texts.join(`\n${"-".repeat(80)}\n\n`));
