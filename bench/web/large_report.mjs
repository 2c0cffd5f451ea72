// SPDX-License-Identifier: Apache-2.0
// Usage: node bench/web/large_report.mjs PAGE.html [CHROMIUM]. Measures the time for opening a study's page, and the
// time in which the panels follow a brush. tests/web/make_studies.py writes large.html with 1,000 designs and 10,000
// missions.
import { resolve } from "node:path";
import { launch, open } from "../../tests/web/browser.mjs";

const [, , file, chromium = "/usr/bin/chromium"] = process.argv;
const OPENINGS = 5;
const BRUSHES = 20;

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Moves the end of a chart's brush in steps. Returns two lists of times [ms]: of each frame, and of all frames from a
 * step until all panels are drawn. */
async function follow(page) {
  return page.evaluate(async (steps) => {
    const { selection } = window.mebots;
    const canvas = [...document.querySelectorAll("canvas")].find((one) => one.setBrush);
    const [frames, all] = [[], []];
    for (let i = 1; i <= steps; ++i) {
      canvas.setBrush(1, [0, i / steps]);
      let sum = 0;
      while (selection.dirty.size > 0) {
        await new Promise(requestAnimationFrame);
        frames.push(selection.lastFrame_ms);
        sum += selection.lastFrame_ms;
      }
      all.push(sum);
    }
    return [frames, all];
  }, BRUSHES);
}

const browser = await launch(chromium);
try {
  const openings = [];
  for (let i = 0; i < OPENINGS; ++i) {
    const begin = performance.now();
    const { page } = await open(browser, resolve(file), { width: 1440 });
    openings.push(performance.now() - begin);
    if (i + 1 < OPENINGS) await page.close();
    else {
      const [frames, all] = await follow(page);
      console.log(`opening: ${median(openings).toFixed(0)} ms in the median, ${Math.min(...openings).toFixed(0)} ms at least`);
      console.log(`brush: ${median(frames).toFixed(1)} ms a frame in the median, ${Math.max(...frames).toFixed(1)} ms at most, ${median(all).toFixed(1)} ms for all panels`);
    }
  }
} finally {
  await browser.close();
}
