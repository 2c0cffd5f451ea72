// SPDX-License-Identifier: Apache-2.0
// Usage: report_test.mjs PAGES [CHROMIUM]. Tests the pages of make_studies.py in a browser.
import assert from "node:assert/strict";
import { join } from "node:path";
import { launch, open } from "./browser.mjs";

const [, , pages, chromium] = process.argv;
if (!chromium || chromium.endsWith("NOTFOUND")) {
  console.log("skipped: there is no Chromium; scripts/setup.sh installs it");
  process.exit(77);
}
// Limits of the work for 1,000 designs and 10,000 missions. 32 designs with 1,024 missions may take a tenth of it.
// bench/web/large_report.mjs measures the time, which depends on the machine.
const MOST_STROKES = 60_000; // calls that draw something or extend a path when the page opens
const MOST_STROKES_OF_A_BRUSH = 30_000;
const TIMES_DRAWN = 1; // drawings per panel for one brush
const MOST_ELEMENTS = 1000;

/** Waits until all panels show the last change. */
const frame = (page) => page.waitForFunction(() => window.mebots.selection.dirty.size === 0);
const state = (page) => page.evaluate(() => {
  const { selection } = window.mebots;
  return { count: selection.count, chosen: selection.chosen, ticked: selection.ticked, rows: [...document.querySelectorAll(".space .row")].map((row) => Number(row.dataset.design)) };
});
const panelOf = (page, title) => page.evaluateHandle((wanted) => [...document.querySelectorAll(".panel")].find((one) => one.querySelector("h2").textContent === wanted), title);

/** Drags along an axis of the parallel coordinates. `from` and `to` are places from 0 to 1. */
async function brush(page, label, from, to) {
  const canvas = await (await panelOf(page, "Parallel coordinates")).$("canvas");
  await canvas.scrollIntoView();
  const [a, b] = await canvas.evaluate((one, name, low, high) => {
    const { left, top } = one.getBoundingClientRect();
    const axis = one.scales.find((each) => each.label === name);
    return [low, high].map((place) => axis.point(place)).map(([x, y]) => [left + x, top + y]);
  }, label, from, to);
  await page.mouse.move(...a);
  await page.mouse.down();
  await page.mouse.move(...b, { steps: 4 });
  await page.mouse.up();
  await frame(page);
}

/** Finds texts of canvases that overlap or leave their canvas, and elements wider than the page. */
const misplaced = (page) => page.evaluate(() => {
  const found = [];
  for (const canvas of document.querySelectorAll(".plot canvas")) {
    const { texts, width, height } = canvas.plot;
    texts.forEach((a, i) => {
      if (a.left < -0.5 || a.right > width + 0.5 || a.top < -0.5 || a.bottom > height + 0.5) found.push(`outside: ${a.text}`);
      for (const b of texts.slice(i + 1)) {
        if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) found.push(`${a.text} over ${b.text}`);
      }
    });
    if (texts.length < 4) found.push(`${canvas.getAttribute("aria-label")}: ${texts.length} texts`);
  }
  if (document.documentElement.scrollWidth > innerWidth) found.push(`the page is ${document.documentElement.scrollWidth} pixels wide`);
  return found;
});

/** Counts the calls that draw. */
function countStrokes() {
  window.strokes = 0;
  for (const name of ["moveTo", "lineTo", "arc", "rect", "fillRect", "stroke", "fill", "fillText", "drawImage"]) {
    const own = CanvasRenderingContext2D.prototype[name];
    CanvasRenderingContext2D.prototype[name] = function counted(...values) {
      ++window.strokes;
      return own.apply(this, values);
    };
  }
}

const tests = {
  async "the page begins with the answer and the ranked table"({ page }) {
    const [headline] = await page.$$eval(".headline", (all) => all.map((one) => one.textContent));
    assert.match(headline, /^Lowest energy among 32 designs with success above 0\.3: .* J \(.* to .*\)/);
    const first = await page.$eval(".space .row", (row) => [...row.children].map((cell) => cell.textContent));
    assert.equal(first[1], "1");
    assert.ok(headline.includes(first[3]), `${headline} does not name ${first[3]}`);
    assert.match(first.join(" "), /1\.5 m\/s, (102\.7|175) MHz/);
  },

  async "the table sorts by each column, both ways"({ page }) {
    const heads = await page.$$(".head button");
    for (const head of heads) {
      const values = async () => {
        await head.click();
        return (await state(page)).rows;
      };
      const [up, down] = [await values(), await values()];
      assert.equal(up.length, down.length);
    }
    const energy = heads[await page.$$eval(".head button", (all) => all.findIndex((one) => one.textContent.startsWith("energy")))];
    await energy.click();
    const means = await page.evaluate(() => {
      const { objectives, designs } = window.mebots.study;
      return [...document.querySelectorAll(".space .row")].map((row) => objectives[1].mean[designs.number.indexOf(Number(row.dataset.design))]);
    });
    assert.deepEqual(means, [...means].sort((a, b) => a - b));
    await (await page.$(".head button")).click();
  },

  async "a brush along an axis filters the table and all panels"({ page }) {
    const titles = ["Front", "Main effects", "Interactions", "Distributions", "Convergence"];
    const read = (body) => Promise.all(titles.map(async (title) => (await panelOf(page, title)).evaluate(body)));
    const look = () => read((one) => one.innerText + [...one.querySelectorAll("canvas")].map((canvas) => canvas.toDataURL()).join());
    const texts = () => read((one) => one.innerText);
    const [before, beginning] = [await look(), await texts()];
    await brush(page, "cruise_speed [m/s]", -0.05, 0.4);
    const { count, rows } = await state(page);
    assert.equal(count, 16);
    const speeds = await page.evaluate((shown) => shown.map((i) => window.mebots.study.factors[1].values[i]), rows);
    assert.ok(speeds.length > 0 && speeds.every((speed) => speed <= 0.6), speeds.join(" "));
    const after = await look();
    titles.forEach((title, i) => assert.ok(after[i] !== before[i], `${title} did not change`));
    await brush(page, "clock [MHz]", 0.8, 1.05);
    assert.equal((await state(page)).count, 8);
    assert.match(await page.$eval(".toolbar .status", (one) => one.textContent), /^8 of 32 designs selected$/);
    await page.click(".toolbar button");
    await frame(page);
    assert.equal((await state(page)).count, 32);
    assert.deepEqual(await texts(), beginning);
  },

  async "the axis of a share ends at 100 %"({ page }) {
    const front = await panelOf(page, "Front");
    const [, up] = await front.$$("select");
    const before = await up.evaluate((one) => one.value);
    await up.select("0");
    const [top, most] = await front.$eval("canvas", (one) => [one.plot.at(0, one.plot.box.top)[1], Math.max(...window.mebots.study.objectives[0].mean)]);
    assert.equal(most, 1);
    assert.ok(Math.abs(top - 1) < 1e-9, `${top}`);
    await up.select(before);
  },

  async "means of a selection of all designs are those that Python computed"({ page }) {
    const differences = await page.evaluate(() => {
      const { study, selection } = window.mebots;
      selection.filter("test", () => true);
      return study.factors.flatMap((factor, number) => factor.levels.map((_, level) => {
        const own = study.objectives[1].mean.filter((mean, i) => factor.level[i] === level && mean !== null);
        return Math.abs(own.reduce((a, b) => a + b, 0) / own.length - study.effects.means[1][number][level]);
      }));
    });
    await frame(page);
    const shown = await page.$$eval(".effect td.number", (cells) => cells.map((cell) => cell.textContent));
    await page.evaluate(() => window.mebots.selection.reset());
    await frame(page);
    assert.deepEqual(await page.$$eval(".effect td.number", (cells) => cells.map((cell) => cell.textContent)), shown);
    assert.ok(Math.max(...differences) < 1e-9, differences.join(" "));
  },

  async "the keyboard alone chooses a design, shows its missions and closes it"({ page }) {
    await page.focus(".view");
    await page.keyboard.press("ArrowDown");
    await page.keyboard.press("ArrowDown");
    await frame(page);
    assert.match(await page.$eval(".details h2", (one) => one.textContent), /rank 2$/);
    await page.keyboard.press("Space");
    await frame(page);
    assert.equal((await state(page)).ticked.length, 1);
    await page.keyboard.press("Escape");
    await frame(page);
    assert.equal((await state(page)).chosen, -1);
    await page.evaluate(() => window.mebots.selection.clearTicks());
    await (await (await panelOf(page, "Front")).$("canvas")).focus();
    for (const key of ["ArrowRight", "ArrowRight", "ArrowLeft"]) {
      await page.keyboard.press(key);
      await frame(page);
    }
    const lowest = await page.evaluate(() => {
      const { mean } = window.mebots.study.objectives[1];
      return mean.indexOf(Math.min(...mean.filter((one) => one !== null)));
    });
    assert.equal((await state(page)).chosen, lowest);
    await page.evaluate(() => window.mebots.selection.choose(-1));
  },

  async "a click on a mission shows the command that replays it, and ticked ones the comparison"({ page }) {
    await page.evaluate(() => window.mebots.selection.choose(3));
    await frame(page);
    await page.click(".missions tbody tr:nth-child(5)");
    const command = await page.$eval(".details .command code", (one) => one.textContent);
    const { run, folder, designs, draws } = await page.evaluate(() => window.mebots.study.replay);
    assert.equal(command, `${run} --out ${folder}/design_3_mission_4 ${designs[3]} ${draws[4]} && mebots report ${folder}/design_3_mission_4`);
    assert.deepEqual(await page.$$eval(".details .command code", (all) => all.slice(1).map((one) => one.textContent)), [`${command.split(" && ")[0]} --live`]);
    assert.equal(await page.$eval(".details a", (one) => one.getAttribute("href")), "replays/design_3_mission_4/flight.html");
    for (const row of [2, 5]) await page.click(`.missions tbody tr:nth-child(${row}) input`);
    await frame(page);
    await page.click(".compare-bar .primary");
    const lines = (await page.$eval("dialog[open] code", (one) => one.textContent)).split("\n");
    assert.equal(lines.length, 3);
    assert.equal(lines[2], `mebots report ${folder}/design_3_mission_1 ${folder}/design_3_mission_4 --out ${folder}/compared.html`);
    await page.keyboard.press("Escape");
    await page.evaluate(() => { window.mebots.selection.clearTicks(); window.mebots.selection.choose(-1); });
  },

  async "a click on a point of the front chooses its design"({ page }) {
    const canvas = await (await panelOf(page, "Front")).$("canvas");
    await canvas.scrollIntoView();
    const [x, y, nearest] = await canvas.evaluate((one) => {
      const { objectives } = window.mebots.study;
      const { left, top } = one.getBoundingClientRect();
      const slowest = objectives[2].mean.indexOf(Math.max(...objectives[2].mean.filter((mean) => mean !== null)));
      return [left + one.plot.x(objectives[1].mean[slowest]), top + one.plot.y(objectives[2].mean[slowest]), slowest];
    });
    await page.mouse.click(x, y);
    await frame(page);
    assert.equal((await state(page)).chosen, nearest);
    await page.evaluate(() => window.mebots.selection.choose(-1));
  },
};

const browser = await launch(chromium);
let failures = 0;
async function check(name, body) {
  try {
    await body();
    console.log(`passed: ${name}`);
  } catch (error) {
    ++failures;
    console.log(`FAILED: ${name}\n  ${error.message}`);
  }
}

try {
  const main = await open(browser, join(pages, "study.html"), { width: 1440 });
  for (const [name, body] of Object.entries(tests)) await check(name, () => body(main));
  await check("it needs no network and reports no error", () => {
    assert.deepEqual(main.problems, []);
    assert.deepEqual(main.requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
  });
  for (const name of ["study", "large", "rare", "network"]) {
    for (const [width, dark] of [[1440, false], [390, true]]) {
      await check(`${name} at ${width} pixels: no text lies over another one, and nothing is cut off`, async () => {
        const { page, problems } = await open(browser, join(pages, `${name}.html`), { width, height: 900, dark, touch: width < 500 });
        assert.deepEqual(problems, []);
        assert.deepEqual(await misplaced(page), []);
        await page.close();
      });
    }
  }
  await check("the page of a network has its cost, all layers, and shares that add up", async () => {
    const { page, problems, requests } = await open(browser, join(pages, "network.html"), { width: 1440 });
    const { measured, layers } = await page.evaluate(() => window.mebots.page.network);
    const headline = await page.$eval(".headline", (one) => one.textContent);
    assert.equal(headline, `One inference takes ${(1e3 * measured.total.time).toPrecision(4)} ms and ${(1e3 * measured.total.energy).toPrecision(4)} mJ on 8 cores at 87.00 MHz.`);
    const rows = await page.$$eval(".layers tbody tr", (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
    assert.equal(rows.length, layers.length + 1);
    const whole = (text) => Number(text.replaceAll(",", ""));
    assert.deepEqual(rows.slice(0, -1).map((row) => whole(row[5])), measured.layers.map(({ cycles }) => cycles));
    assert.equal(rows.slice(0, -1).reduce((sum, row) => sum + whole(row[5]), 0), whole(rows.at(-1)[5]));
    for (const title of ["Where the cycles go", "Where the joules go"]) {
      const panel = await panelOf(page, title);
      const widths = () => panel.evaluate((one) => [...one.querySelectorAll(".split")].map((bar) => {
        const pieces = [...bar.querySelectorAll(".pieces i")].map((piece) => piece.getBoundingClientRect().width);
        return [pieces.reduce((a, b) => a + b, 0), bar.querySelector(".rail").getBoundingClientRect().width];
      }));
      const proportional = await widths();
      const most = Math.max(...measured.layers.map((cost) => cost.cycles));
      measured.layers.forEach((cost, i) => assert.ok(Math.abs(proportional[i][0] / proportional[i][1] - cost.cycles / most) < 0.02, `${title}, layer ${i}: ${proportional[i]}`));
      await (await panel.$("select")).select("1");
      for (const [length, rail] of await widths()) assert.ok(Math.abs(length - rail) < 1, `${length} of ${rail}`);
      const shares = await panel.$$eval(".key span", (all) => all.map((one) => Number(/([\d.]+) %/.exec(one.textContent)[1])));
      assert.ok(Math.abs(shares.reduce((a, b) => a + b, 0) - 100) < 1.5, shares.join(" "));
    }
    const energies = await (await panelOf(page, "Clocks and numbers of cores")).$$eval("tbody tr", (all) => all.map((row) => row.children[3].textContent));
    assert.equal(energies.length, 12);
    const sizes = await (await panelOf(page, "Accuracy next to energy")).$$eval("tbody tr", (all) => all.map((row) => [row.children[0].textContent, row.children[5].textContent]));
    assert.deepEqual(sizes, [["160 x 160", "0.01 (0.008 to 0.012)"], ["120 x 120", "0.0133 (0.0107 to 0.016)"], ["80 x 80", "0.02 (0.016 to 0.024)"]]);
    const disc = await (await panelOf(page, "Roofline")).$("canvas");
    await disc.scrollIntoView();
    const [x, y] = await disc.evaluate((one) => {
      const { layers, measured } = window.mebots.page.network;
      const { left, top } = one.getBoundingClientRect();
      return [left + one.plot.x(layers[1].macs / layers[1].l1.moved), top + one.plot.y(measured.layers[1].macs_per_cycle)];
    });
    await page.mouse.move(x, y);
    assert.match(await page.$eval(".tooltip:not([hidden])", (one) => one.textContent), /33 % of the roofline/);
    assert.deepEqual(problems, []);
    assert.deepEqual(requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
    await page.close();
  });
  await check("a network that was not measured has layers and memory, and no cost", async () => {
    const { page, problems } = await open(browser, join(pages, "unmeasured.html"), { width: 1440 });
    assert.deepEqual(await page.$$eval(".panel h2", (all) => all.map((one) => one.textContent)), ["Layers", "Memory over time"]);
    assert.match(await page.$eval(".headline", (one) => one.textContent), /^Not measured/);
    assert.deepEqual(problems, []);
    await page.close();
  });
  await check("the page of a running study loads itself again, unless a design is chosen", async () => {
    const { page, problems } = await open(browser, join(pages, "live.html"), { width: 1440 });
    assert.match(await page.$eval(".headline", (one) => one.textContent), /96 flown/);
    await page.waitForFunction(() => performance.getEntriesByType("navigation")[0].type === "reload" && document.documentElement.dataset.state === "ready");
    await page.evaluate(() => { window.mark = 1; window.mebots.selection.choose(0); });
    await new Promise((done) => setTimeout(done, 2200));
    assert.equal(await page.evaluate(() => window.mark), 1);
    assert.deepEqual(problems, []);
    await page.close();
  });
  await check("1,000 designs and 10,000 missions are thinned: the work to open the page and to follow a brush is bounded", async () => {
    const { page } = await open(browser, join(pages, "large.html"), { width: 1440, prepare: countStrokes });
    const strokes = () => page.evaluate(() => [window.strokes, (window.strokes = 0)][0]);
    assert.match(await page.$eval(".answer .faint", (one) => one.textContent), /^1,000 designs, 10,000 missions/);
    await frame(page);
    const opening = await strokes();
    assert.ok(opening > 5000 && opening < MOST_STROKES, `${opening} strokes`);
    const { most, visible } = await page.evaluate(async () => {
      const { selection } = window.mebots;
      const canvas = [...document.querySelectorAll("canvas")].find((one) => one.setBrush);
      let drawn = 0;
      selection.onChange(() => { ++drawn; });
      const worst = { strokes: 0, drawn: 0 };
      for (let i = 1; i <= 20; ++i) {
        [window.strokes, drawn] = [0, 0];
        // Several movements of the brush before the next frame must cause only one drawing.
        for (const part of [0.3, 0.6, 1]) canvas.setBrush(1, [0, (i - 1 + part) / 20]);
        while (selection.dirty.size > 0) await new Promise(requestAnimationFrame);
        worst.strokes = Math.max(worst.strokes, window.strokes);
        worst.drawn = Math.max(worst.drawn, drawn);
      }
      return { most: worst, visible: document.querySelectorAll("*").length };
    });
    console.log(`${opening} strokes at the opening, ${most.strokes} after a brush, ${visible} elements`);
    assert.ok(most.strokes > 1000 && most.strokes < MOST_STROKES_OF_A_BRUSH, `${most.strokes} strokes after a brush`);
    assert.equal(most.drawn, TIMES_DRAWN);
    assert.ok(visible < MOST_ELEMENTS, `${visible} elements`);
    assert.ok((await state(page)).rows.length < 40, "the table has all rows in the document");
    await page.close();
  });
} finally {
  await browser.close();
}
console.log(`${failures} failed`);
process.exit(failures ? 1 : 0);
