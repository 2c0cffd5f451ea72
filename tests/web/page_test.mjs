// SPDX-License-Identifier: Apache-2.0
// Usage: page_test.mjs RUNS [CHROMIUM]
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, open } from "./browser.mjs";

const [, , runs, chromium] = process.argv;
if (!chromium || chromium.endsWith("NOTFOUND")) {
  console.log("skipped: there is no Chromium; scripts/setup.sh installs it");
  process.exit(77);
}
const pageOf = (run) => join(runs, run, "flight.html");

/** Returns a column of results.csv as numbers. No name may contain a comma. */
function column(run, name) {
  const [head, ...lines] = readFileSync(join(runs, run, "results.csv"), "utf8").trim().split("\n");
  const place = head.split(",").findIndex((title) => title.startsWith(`${name} [`));
  assert.notEqual(place, -1, `${run} has no ${name}`);
  return lines.map((line) => Number(line.split(",")[place]));
}

/** Returns the value in the last row of results.csv whose time is not later than `time`. */
function valueAt(run, name, time) {
  const times = column(run, "time");
  return column(run, name)[times.findLastIndex((each) => each <= time)];
}

const setTime = (page, time) => page.evaluate((t) => globalThis.mebots.clock.set(t), time);
const frame = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));

/** Returns the number of different colours on a canvas. */
const colours = (page, selector) => page.evaluate((which) => {
  const shown = document.querySelector(which);
  const copy = document.createElement("canvas");
  copy.width = shown.width;
  copy.height = shown.height;
  const context = copy.getContext("2d");
  context.drawImage(shown, 0, 0);
  const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
  return new Set(pixels).size;
}, selector);

/** Finds visible texts that overlap. The box of a text encloses its letters, and ends at the edges of ancestors that
 * hide overflowing content. */
const overlaps = (page) => page.evaluate(() => {
  const boxes = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let text = texts.nextNode(); text; text = texts.nextNode()) {
    const owner = text.parentElement;
    if (!text.textContent.trim() || owner.closest("script, style, select, .menu") || !owner.checkVisibility({ checkOpacity: true, checkVisibilityCSS: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(text);
    for (const line of range.getClientRects()) {
      let { left, right, top, bottom } = line;
      let layer = "page";
      for (let one = owner; one; one = one.parentElement) {
        const style = getComputedStyle(one);
        if (style.position === "fixed" || style.position === "sticky") layer = one.className || one.tagName;
        if (style.overflowX === "visible" && style.overflowY === "visible") continue;
        const clip = one.getBoundingClientRect();
        [left, right, top, bottom] = [Math.max(left, clip.left), Math.min(right, clip.right), Math.max(top, clip.top), Math.min(bottom, clip.bottom)];
      }
      if (right - left > 2 && bottom - top > 4) boxes.push({ left, right, top: top + 2, bottom: bottom - 2, layer, text: text.textContent.trim() });
    }
  }
  const found = boxes.flatMap((a, i) => boxes.slice(i + 1)
    .filter((b) => a.layer === b.layer && a.left + 1 < b.right && b.left + 1 < a.right && a.top < b.bottom && b.top < a.bottom)
    .map((b) => `${a.text} over ${b.text}`));
  if (document.documentElement.scrollWidth > innerWidth) found.push(`the page is ${document.documentElement.scrollWidth} pixels wide`);
  return { count: boxes.length, found };
});

const overlapTests = {
  async "no text lies over another one, at several moments"({ page }) {
    for (const share of [0, 0.3, 0.7, 1]) {
      await page.evaluate((part) => globalThis.mebots.clock.set(part * globalThis.mebots.runs[0].end), share);
      await frame(page);
      const { count, found } = await overlaps(page);
      assert.ok(count > 25, `${count} texts`);
      assert.deepEqual(found, [], `at ${share} of the run`);
    }
  },
};

/** Converts a text such as "0.2778 m/s" or "9.514 mW" to a number in the unit without prefix. */
function numberOf(text) {
  const [, number, prefix] = /^([−\d.e+-]+) ?([GMkmµn]?)/.exec(text.replace(/ (m|m\/s|rad\/s)$/, ""));
  return Number(number.replace("−", "-")) * { "": 1, G: 1e9, M: 1e6, k: 1e3, m: 1e-3, "µ": 1e-6, n: 1e-9 }[prefix];
}

const tests = {
  async "the scene and every plot have drawn pixels"({ page }) {
    assert.ok((await colours(page, "#scene")) > 200, "the scene shows next to nothing");
    const plots = await page.$$(".chart canvas");
    assert.ok(plots.length >= 6, `${plots.length} plots`);
    for (let i = 0; i < plots.length; ++i) {
      const id = await plots[i].evaluate((canvas, n) => (canvas.id ||= `plot-${n}`), i);
      assert.ok((await colours(page, `#${id}`)) > 3, `plot ${i} is empty`);
    }
  },

  async "scrubbing to a moment shows that moment's numbers"({ page }) {
    for (const time of [0.5, 3.1, 1.7]) {
      await setTime(page, time);
      for (const name of ["world.drone.position.z", "battery.cell.voltage", "soc.setpoint.altitude"]) {
        const text = await page.$eval(`.values b[data-variable="${name}"]`, (cell) => cell.textContent);
        const wanted = valueAt("flight", name, time);
        assert.ok(Math.abs(numberOf(text) - wanted) <= 1e-3 * Math.abs(wanted) + 1e-5, `${name} at ${time} s: ${text}, not ${wanted}`);
      }
      assert.match(await page.$eval("#now", (now) => now.textContent), new RegExp(`^${time.toFixed(2)} s /`));
    }
  },

  async "where the firmware's time goes is told in per cent of it"({ page }) {
    const panel = await page.evaluateHandle(() => [...document.querySelectorAll(".panel")].find((each) => each.querySelector('[data-variable="soc.state_time.asleep"]')));
    await setTime(page, 3);
    const shares = await panel.$$eval(".values b", (cells) => cells.map((cell) => cell.textContent));
    assert.ok(shares.every((text) => /^[\d.e-]+ %$/.test(text)), shares.join(", "));
    assert.ok(Math.abs(shares.map((text) => parseFloat(text)).reduce((a, b) => a + b) - 100) < 0.5, shares.join(", "));
  },

  async "lanes lie along the same time as the plots above them"({ page }) {
    const [plot, lane] = await page.evaluate(() => [".panel .u-over", ".panel .lane-area"].map((which) => {
      const { left, right } = document.querySelector(which).getBoundingClientRect();
      return [left, right];
    }));
    plot.forEach((edge, i) => assert.ok(Math.abs(edge - lane[i]) < 1, `${plot}, ${lane}`));
  },

  async "every core's lane is dark when that core worked"({ page }) {
    for (const time of [1, 3]) {
      await setTime(page, time);
      for (let core = 0; core < 8; ++core) {
        const name = `soc.cluster.core[${core}].cycles`;
        const text = await page.$eval(`.values b[data-variable="${name}"]`, (cell) => cell.textContent);
        assert.equal(numberOf(text.replace("/s", "")) > 0, time > 2, `${name} at ${time} s: ${text}`);
      }
    }
    const cells = await page.$$eval('.values b[data-variable="world.drone.phase"]', (found) => found.map((cell) => cell.textContent));
    assert.deepEqual(cells, ["flying"]);
    const wanted = [0, 1, 2, 3, 4, 5, 6, 7].map((core) => column("flight", `soc.cluster.core[${core}].cycles`).at(-1)).reduce((a, b) => a + b);
    assert.equal(wanted, column("flight", "soc.cluster.cycles").at(-1));
  },

  async "mean power over all of the run is energy over time"({ page }) {
    const shown = await page.evaluate(() => {
      const run = globalThis.mebots.runs[0];
      return run.curve({ rate_of: "battery.motors.energy" }).values(run.end)[1];
    });
    const energy = column("flight", "battery.motors.energy");
    const times = column("flight", "time");
    assert.ok(Math.abs(shown - (energy.at(-1) - energy[0]) / times.at(-1)) < 1e-9 * shown);
  },

  async "dragging on the timeline moves the moment, and the scene with it"({ page }) {
    await setTime(page, 1.7);
    await frame(page);
    const before = await page.$eval("#scene", (canvas) => canvas.toDataURL());
    const box = await (await page.$(".track")).boundingBox();
    await page.mouse.move(box.x + 0.2 * box.width, box.y + box.height - 8);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.75 * box.width, box.y + box.height - 8, { steps: 3 });
    await page.mouse.up();
    await frame(page);
    assert.ok(Math.abs((await page.evaluate(() => globalThis.mebots.clock.time)) - 3) < 0.05);
    assert.ok((await page.$eval("#scene", (canvas) => canvas.toDataURL())) !== before, "the scene stands still");
  },

  async "keys play, step by row, and choose the camera"({ page }) {
    await setTime(page, 1);
    await page.evaluate(() => document.activeElement?.blur());
    const times = column("flight", "time");
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.evaluate(() => globalThis.mebots.clock.time), times.find((time) => time > 1 + 1e-9));
    await page.keyboard.press("End");
    assert.equal(await page.evaluate(() => globalThis.mebots.clock.time), 4);
    for (const [key, look] of [["2", "free"], ["3", "top"], ["4", "onboard"], ["1", "follow"]]) {
      await page.keyboard.press(key);
      assert.equal(await page.$eval('.tools [aria-pressed="true"]', (button) => button.textContent), look);
    }
    await setTime(page, 0);
    await page.keyboard.press("Space");
    await page.waitForFunction(() => globalThis.mebots.clock.time > 0.05, { timeout: 20000 });
    await page.keyboard.press("Space");
    const stood = await page.evaluate(() => globalThis.mebots.clock.time);
    await frame(page);
    assert.equal(await page.evaluate(() => globalThis.mebots.clock.time), stood);
  },

  async "it says what the mission is and what happened"({ page }) {
    assert.match(await page.$eval(".story .about", (text) => text.textContent), /finds a gate by its camera/);
    const happened = await page.$eval(".story .happened", (text) => text.textContent);
    const delivered = JSON.parse(readFileSync(join(runs, "flight", "summary.json"), "utf8")).energy.delivered;
    assert.match(happened, /^Ran 4\.000 s: timeout; [\d.]+ J, \d\d % of it motors; \d\d\.\d % of the charge left\.$/);
    assert.ok(Math.abs(Number(/; ([\d.]+) J/.exec(happened)[1]) - delivered) < 1e-3 * delivered, happened);
  },

  async "a search knows what altitude and volts are"({ page }) {
    await page.click('[data-tab="Variables"]');
    const found = async (words) => {
      await page.$eval("#search", (box) => (box.value = ""));
      await page.type("#search", words);
      return page.$$eval(".signals tbody button", (buttons) => buttons.map((button) => button.textContent));
    };
    assert.ok((await found("altitude")).includes("world.drone.position.z"));
    const volts = await found("volt battery");
    assert.ok(volts.includes("battery.cell.voltage") && !volts.includes("world.drone.position.z"), String(volts));
    await page.$eval("#search", (box) => { box.value = ""; box.dispatchEvent(new Event("input")); box.blur(); });
  },

  async "escape closes the keys, and shows all of a plot"({ page }) {
    await page.keyboard.press("?");
    assert.ok(await page.$("dialog[open]"));
    await page.keyboard.press("Escape");
    assert.equal(await page.$("dialog[open]"), null);
    await page.evaluate(() => globalThis.mebots.span.set(1, 2));
    await page.keyboard.press("Escape");
    assert.ok(await page.evaluate(() => globalThis.mebots.span.isWhole));
  },

  async "a drag on a plot chooses a span, a click the moment, and shift exchanges them"({ page }) {
    await setTime(page, 1);
    const box = await (await page.$(".chart .u-over")).boundingBox();
    const drag = async (from, to) => {
      await page.mouse.move(box.x + from * box.width, box.y + 20);
      await page.mouse.down();
      await page.mouse.move(box.x + to * box.width, box.y + 20, { steps: 3 });
      await page.mouse.up();
      return page.evaluate(() => ({ start: globalThis.mebots.span.start, stop: globalThis.mebots.span.stop, time: globalThis.mebots.clock.time }));
    };
    const { start, stop, time } = await drag(0.25, 0.75);
    assert.ok(Math.abs(start - 1) < 0.05 && Math.abs(stop - 3) < 0.05, `${start} to ${stop}`);
    assert.equal(time, 1);
    assert.equal(await page.$(".marked"), null);
    await page.keyboard.press("Escape");
    const clicked = await drag(0.625, 0.625);
    assert.ok(Math.abs(clicked.time - 2.5) < 0.05 && clicked.start === 0 && clicked.stop === 4, JSON.stringify(clicked));
    await page.keyboard.down("Shift");
    const moved = await drag(0.25, 0.75);
    await page.keyboard.up("Shift");
    assert.ok(Math.abs(moved.time - 3) < 0.05 && moved.start === 0 && moved.stop === 4, JSON.stringify(moved));
  },

  async "every plot marks the time under the pointer, and its numbers are of that time"({ page }) {
    await setTime(page, 1);
    const box = await (await page.$(".chart .u-over")).boundingBox();
    await page.mouse.move(box.x + 0.75 * box.width, box.y + 20);
    const lines = await page.$$eval(".panel .pointed", (found) => found.map((line) => [line.style.display, parseFloat(line.style.left)]));
    assert.ok(lines.length >= 8, `${lines.length} lines`);
    for (const [display, left] of lines) assert.ok(display === "block" && Math.abs(left - 75) < 1, `${display} ${left}`);
    const pointed = await page.evaluate(() => globalThis.mebots.span.pointed);
    const text = await page.$eval('.values b[data-variable="battery.cell.voltage"]', (cell) => cell.textContent);
    const wanted = valueAt("flight", "battery.cell.voltage", pointed);
    assert.ok(Math.abs(numberOf(text) - wanted) <= 1e-3 * wanted, `${text}, not ${wanted}`);
    assert.equal(await page.evaluate(() => globalThis.mebots.clock.time), 1);
    await page.mouse.move(5, 5);
    assert.equal(await page.evaluate(() => globalThis.mebots.span.pointed), null);
  },

  async "scene, columns and every plot take another size by a drag or by keys"({ page }) {
    const sizeOf = (selector, which) => page.$eval(selector, (part, name) => part.getBoundingClientRect()[name], which);
    const drag = async (selector, x, y) => {
      const box = await (await page.$(selector)).boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width / 2 + x, box.y + box.height / 2 + y, { steps: 3 });
      await page.mouse.up();
      await frame(page);
    };
    for (const [part, handle, which, x, y] of [[".left", "main > .handle", "width", -150, 0], [".stage", ".left > .handle", "height", 0, -90],
      [".panel-stack .chart canvas", ".panel-stack > .handle", "height", 0, 60], [".panel-lanes .lane-area", ".panel-lanes > .handle", "height", 0, 30]]) {
      await page.$eval(handle, (bar) => bar.scrollIntoView({ block: "center" }));
      const before = await sizeOf(part, which);
      await drag(handle, x, y);
      const after = await sizeOf(part, which);
      assert.ok(Math.abs(after - before - x - y) < 8, `${part}: ${before} to ${after}`);
      await page.focus(handle);
      await page.keyboard.press(which === "width" ? "ArrowRight" : "ArrowDown");
      await frame(page);
      assert.ok((await sizeOf(part, which)) > after + 8, `${part} takes no keys`);
      await page.$eval(handle, (bar) => bar.dispatchEvent(new MouseEvent("dblclick", { bubbles: true })));
      await frame(page);
      assert.ok(Math.abs((await sizeOf(part, which)) - before) < 2, `${part} is not as before`);
    }
    await page.evaluate(() => document.activeElement?.blur());
  },

  async "sizes are those of the page before, until a double click"({ page }) {
    const widthOf = (one) => one.$eval(".left", (part) => part.getBoundingClientRect().width);
    const press = async (one, keys) => {
      await one.focus("main > .handle");
      for (let i = 0; i < keys; ++i) await one.keyboard.press("ArrowLeft");
      await frame(one);
    };
    const first = await widthOf(page);
    await press(page, 5);
    const narrow = await widthOf(page);
    assert.ok(narrow < first - 60, `${first} to ${narrow}`);
    const file = fileURLToPath(new URL(page.url()));
    const next = await open(browser, file);
    assert.ok(Math.abs((await widthOf(next.page)) - narrow) < 2, `${narrow}, then ${await widthOf(next.page)}`);
    assert.deepEqual(next.problems, []);
    await next.page.$eval("main > .handle", (bar) => bar.dispatchEvent(new MouseEvent("dblclick", { bubbles: true })));
    await next.page.close();
    const last = await open(browser, file);
    assert.ok(Math.abs((await widthOf(last.page)) - first) < 2, "a double click forgets the size");
    await last.page.close();
    await page.$eval("main > .handle", (bar) => bar.dispatchEvent(new MouseEvent("dblclick", { bubbles: true })));
    await page.evaluate(() => document.activeElement?.blur());
  },

  async "the picture is the last that the camera took"({ page }) {
    await setTime(page, 1);
    assert.equal(await page.$eval(".picture figcaption", (caption) => caption.textContent), "no picture yet");
    await setTime(page, 3);
    assert.match(await page.$eval(".picture figcaption", (caption) => caption.textContent), /camera at 2\.\d\d s/);
    await page.waitForFunction(() => document.querySelector(".picture img").naturalWidth === 320, { timeout: 10000 });
  },

  async "every recorded variable is found by a word, and plotted at a click"({ page }) {
    await page.click('[data-tab="Variables"]');
    await page.type("#search", "rotor thrust");
    const found = await page.$$eval(".signals tbody button", (buttons) => buttons.map((button) => button.textContent));
    assert.deepEqual(found, [1, 2, 3, 4].map((rotor) => `motors.rotor[${rotor}].thrust`));
    const before = (await page.$$(".panel")).length;
    await page.click(".signals tbody button");
    assert.equal((await page.$$(".panel")).length, before + 1);
  },

  async "the flame graph is of the span of time that the plots show"({ page }) {
    await page.click('[data-tab="Profile"]');
    await page.click(".profile input[type=checkbox]"); // includes sleep, so that all of the chip's energy is counted
    const energies = column("flight", "soc.energy.total");
    const times = column("flight", "time");
    for (const [from, to] of [[0, 4], [2.9, 3.1], [0.5, 2]]) {
      await page.evaluate((a, b) => globalThis.mebots.span.set(a, b), from, to);
      await frame(page);
      const note = await page.$eval("#flame-note", (text) => text.textContent);
      const [, energy, start, stop] = /^([^,]*J), .* from ([\d.]+) s to ([\d.]+) s/.exec(note);
      assert.ok(Number(start) <= from + 1e-9 && Number(stop) >= to - 1e-9 && stop - start < to - from + 0.05, note);
      // A window of the profile may start or end between two rows of results.csv. Therefore its energy differs a little from the difference
      // between two rows.
      const at = (time) => energies[Math.min(times.findIndex((each) => each >= time - 0.006), times.length - 1)];
      const wanted = at(Number(stop)) - at(Number(start));
      assert.ok(Math.abs(numberOf(energy) - wanted) < 0.004 * wanted + 0.03 * 6e-3, `${note}: not ${wanted} J`);
    }
    await page.evaluate(() => globalThis.mebots.span.reset());
    await page.click(".profile input[type=checkbox]");
    await page.waitForFunction(() => [...document.querySelectorAll(".flames .d3-flame-graph-label")].some((label) => label.textContent.includes("nn_")),
      { timeout: 10000 });
    await page.click('[data-tab="Messages"]');
  },

  async "looking closer shows means over less time"({ page }) {
    const span = () => page.$eval(".panel .unit:nth-of-type(2)", (note) => /over (.*)$/.exec(note.textContent)[1]).then(numberOf);
    const before = await span();
    await page.evaluate(() => document.querySelector(".panels").scrollTo(0, 0));
    const box = await (await page.$(".panel-stack .u-over")).boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.keyboard.down("Control");
    await page.mouse.wheel({ deltaY: -400 });
    await page.keyboard.up("Control");
    await frame(page);
    assert.ok((await span()) < before);
  },
};

const phoneTests = {
  "the scene and every plot have drawn pixels": tests["the scene and every plot have drawn pixels"],

  async "two fingers that part look closer at what lies between them"({ page }) {
    await page.evaluate(() => document.querySelector(".panel-stack .u-over").scrollIntoView({ block: "center" }));
    const box = await (await page.$(".panel-stack .u-over")).boundingBox();
    const client = await page.createCDPSession();
    const fingers = (apart) => [-1, 1].map((side, id) => ({ id, x: box.x + box.width * (0.5 + side * apart), y: box.y + box.height / 2 }));
    await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: fingers(0.1) });
    for (const apart of [0.15, 0.2, 0.3]) await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: fingers(apart) });
    await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await frame(page);
    const [from, to] = await page.evaluate(() => [globalThis.mebots.span.start, globalThis.mebots.span.stop]);
    assert.ok(Math.abs((from + to) / 2 - 2) < 0.15, `${from} to ${to}`);
    assert.ok(Math.abs(to - from - 4 / 3) < 0.2, `${from} to ${to}`);
    await page.evaluate(() => globalThis.mebots.span.reset());
  },
};

const longTests = {
  async "of a chosen span every row is here, of the rest the extremes"({ page }) {
    const times = await page.evaluate(() => [...globalThis.mebots.runs[0].times]);
    const whole = column("long", "time");
    assert.ok(times.length < whole.length);
    const within = (list) => list.filter((time) => time >= 20 && time <= 21);
    assert.deepEqual(within(times), within(whole));
    const shown = await page.evaluate(() => [...globalThis.mebots.runs[0].values("motors.power")]);
    const power = column("long", "motors.power");
    assert.equal(shown[times.indexOf(20.5)], power[whole.indexOf(20.5)]);
    assert.equal(Math.max(...shown), Math.max(...power));
  },

  async "who looks closer elsewhere is told how to get every row"({ page }) {
    const told = async (from, to) => {
      await page.evaluate((a, b) => globalThis.mebots.span.set(a, b), from, to);
      return page.$eval(".thin-note", (note) => (note.hidden ? "" : note.textContent));
    };
    assert.match(await told(5, 6), /mebots report long --detail 5:6$/);
    assert.equal(await told(20.2, 20.8), "");
    assert.equal(await told(0, 40), "");
  },
};

const systemOnPhoneTests = {
  async "the graph comes before the plots, and nothing is wider than the page"({ page }) {
    const topOf = (selector) => page.$eval(selector, (one) => one.getBoundingClientRect().top);
    assert.ok((await topOf(".graph svg")) < (await topOf(".panels .panel")));
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
    assert.ok((await page.$eval(".graph .box rect", (one) => one.getBoundingClientRect().height)) < 75);
  },
};

const systemTests = {
  async "a run without a world shows its system as a graph with units"({ page }) {
    assert.equal(await page.$("#scene"), null);
    const text = await page.$eval(".graph svg", (graph) => graph.textContent);
    assert.match(text, /battery/);
    assert.match(text, /motors/);
    assert.match(text, /bus\.voltage \[V\]/); // the only variable that changes in this group, by its name
    assert.match(text, /2 values: W/);
    assert.ok((await page.$eval(".graph .box rect", (one) => one.getBoundingClientRect().height)) < 75, "few boxes are not blown up");
    assert.equal((await page.$$(".graph .bundle path")).length, 2);
    const rows = await page.$$eval(".connections tbody tr", (found) => found.map((row) => row.textContent));
    assert.equal(rows.length, 2 + 3, rows.join("\n")); // two FMUs and three connections
    assert.match(rows[0], /fmu_batteryEquivalent-circuit battery/); // the model's name and the text of its description
    await page.$eval(".graph .box", (box) => box.dispatchEvent(new MouseEvent("click")));
    assert.equal((await page.$$(".connections tbody tr")).length, 1 + 3);
  },

  async "each FMU has a plot before any has its second one, and equal curves are one"({ page }) {
    const titles = await page.$$eval(".panel h2", (found) => found.map((title) => title.textContent));
    assert.equal(new Set(titles.slice(0, 2).map((title) => title.split(":")[0])).size, 2, titles.join("; "));
    const names = await page.$$eval(".panel .value", (found) => found.map((value) => value.textContent));
    assert.ok(names.some((name) => /^rotor\[1\]\.\w+, and 3 alike/.test(name)), names.join("; "));
  },

  async "it plots what moves and tells the time of every instance"({ page }) {
    assert.ok((await page.$$(".chart canvas")).length >= 4);
    await page.click('[data-tab="Numbers"]');
    assert.match(await page.$eval(".statistics", (part) => part.textContent), /slowest step/);
  },
};

const besideTests = {
  async "a sentence on each run comes first"({ page }) {
    const lines = await page.$$eval(".story .happened", (all) => all.map((one) => one.textContent));
    assert.equal(lines.length, 2);
    assert.match(lines[0], /^flight: Ran 4\.000 s: .*% of the charge left\.$/);
    assert.match(lines[1], /^fast: /);
  },

  async "two runs fly in one scene and their curves lie over each other"({ page }) {
    assert.ok((await colours(page, "#scene")) > 200);
    await setTime(page, 3.9);
    const cells = await page.$$eval('.values b[data-variable="world.drone.forward_velocity"]', (found) => found.map((cell) => cell.textContent));
    assert.equal(cells.length, 2);
    ["flight", "fast"].forEach((run, i) => {
      const wanted = valueAt(run, "world.drone.forward_velocity", 3.9);
      assert.ok(Math.abs(numberOf(cells[i]) - wanted) < 1e-3, `${run}: ${cells[i]}, not ${wanted}`);
    });
  },

  async "a name's mark is dashed where its curve is, in the run's colour"({ page }) {
    const marks = await page.$$eval(".values .value", (found) =>
      found.filter((value) => value.textContent.includes("open circuit") || value.textContent.startsWith("cell"))
        .map((value) => [value.textContent.split(" \u00b7 ")[0], value.querySelector(".swatch").classList.contains("dashed")]));
    assert.deepEqual(marks, [["open circuit", false], ["open circuit", false], ["cell", true], ["cell", true]]);
  },

  async "of each run's cores one lane stands for all"({ page }) {
    const names = await page.$$eval(".panel-lanes .values b", (cells) => cells.map((cell) => cell.dataset.variable));
    assert.equal(names.filter((name) => name.includes("soc.cluster.core[7].cycles")).length, 2, names.join(", "));
  },

  async "a table tells what was given differently and what came of it"({ page }) {
    const rows = await page.$$eval(".comparison tr", (found) => found.map((row) => row.textContent));
    assert.ok(rows.some((row) => row.startsWith("soc.mission.cruise_speed") && row.endsWith("0.5")), rows.join("\n"));
    assert.ok(rows.some((row) => row.startsWith("outcome")));
  },

  async "numbers have their difference beside them"({ page }) {
    const [first, last] = ["flight", "fast"].map((run) => JSON.parse(readFileSync(join(runs, run, "summary.json"), "utf8")).energy.delivered);
    const text = await page.$$eval(".comparison tr", (found) => [...found].find((row) => row.cells[0].textContent === "energy · delivered").lastElementChild.textContent);
    const share = ((100 * (last - first)) / first).toPrecision(2);
    assert.ok(text.includes(`${last > first ? "+" : ""}${+share} %`), `${text}, not ${share} %`);
  },

  async "in this table a long text leaves the names their room"({ page }) {
    const broken = await page.$$eval(".comparison td:first-child", (cells) => cells.filter((cell) => cell.scrollWidth > cell.clientWidth || cell.offsetWidth < 80).map((cell) => cell.textContent));
    assert.deepEqual(broken, []);
    const { scrollWidth, clientWidth } = await page.$eval(".comparison", ({ scrollWidth, clientWidth }) => ({ scrollWidth, clientWidth }));
    assert.ok(scrollWidth <= clientWidth, `${scrollWidth} of ${clientWidth} pixels`);
  },
};

const openingTests = {
  async "a flight opens on the way and plays"({ page }) {
    const height = column("flight", "world.drone.position.z");
    const { time, isPlaying } = await page.evaluate(() => ({ time: globalThis.mebots.clock.time, isPlaying: globalThis.mebots.clock.isPlaying }));
    assert.ok(isPlaying || time === 4, `it stands at ${time} s`);
    assert.ok(valueAt("flight", "world.drone.position.z", time) - height[0] > 0.4 * (Math.max(...height) - height[0]), `at ${time} s`);
  },
};

const lengthsTests = {
  async "of runs of different length the page lasts as long as the longest, and the shorter one stands at its end"({ page }) {
    assert.equal(await page.evaluate(() => globalThis.mebots.clock.end), 4);
    for (const time of [1.5, 3.5]) {
      await setTime(page, time);
      const cells = await page.$$eval('.values b[data-variable="world.drone.position.z"]', (found) => found.map((cell) => cell.textContent));
      ["short", "flight"].forEach((run, i) => {
        const wanted = valueAt(run, "world.drone.position.z", time);
        assert.ok(Math.abs(numberOf(cells[i]) - wanted) < 1e-3 * Math.abs(wanted) + 1e-5, `${run} at ${time} s: ${cells[i]}, not ${wanted}`);
      });
    }
    for (const look of ["2", "3", "4", "1"]) {
      await page.keyboard.press(look);
      await frame(page);
      const count = await colours(page, "#scene");
      assert.ok(count > 100, `${count} colours after key ${look}`);
    }
  },
};

const swarmTests = {
  async "the table of drones shows the nearest one and the values of the summary at any moment"({ page }) {
    await page.click('[data-tab="Drones"]');
    const heads = await page.$$eval(".drones th", (found) => found.map((head) => head.textContent));
    const drones = Array.from({ length: 16 }, (_, i) => i + 1);
    for (const time of [0.5, 1.5]) {
      await setTime(page, time);
      const rows = await page.$$eval(".drones tbody tr", (found) => found.map((row) => [...row.cells].map((cell) => cell.textContent)));
      const places = drones.map((drone) => ["x", "y", "z"].map((axis) => valueAt("swarm", `world.drone[${drone}].position.${axis}`, time)));
      assert.equal(rows.length, 16);
      rows.forEach((cells, i) => {
        const distances = places.map((place, other) => (other === i ? Infinity : Math.hypot(...place.map((value, axis) => value - places[i][axis]))));
        assert.equal(cells[0], `drone[${i + 1}]`);
        close(cells[1], Math.min(...distances));
        close(cells[heads.indexOf("altitude")], places[i][2]);
        close(cells[heads.indexOf("state of charge")], valueAt("swarm", `battery[${i + 1}].cell.state_of_charge`, time));
      });
      assert.deepEqual([2, 3, 4].map((drone) => rows[drone - 1][2]), ["drone[1]", "drone[4]", "drone[3]"]); // the third starts next to the fourth
      assert.deepEqual(new Set(rows.map((cells) => cells[heads.indexOf("phase")])), new Set(["climbing"]));
    }
  },

  async "the scene shows all drones at first, and events that all have are one mark"({ page }) {
    const pressed = () => page.$$eval(".tools button[aria-pressed=true]", (buttons) => buttons.map((button) => button.textContent));
    assert.deepEqual(await pressed(), ["free"]);
    const marks = await page.$$eval(".mark:not(.quiet) span", (words) => words.map((word) => word.textContent));
    assert.ok(marks.includes("16 \u00d7 take-off"), marks.join(", "));
    assert.deepEqual(await page.$$eval(".legend button", (buttons) => buttons.map((button) => button.textContent)), Array.from({ length: 16 }, (_, i) => `${i + 1}`));
    await page.click('.legend button[title="Follow drone[3]"]');
    assert.deepEqual(await pressed(), ["follow"]);
  },

  async "a click on a drone lets the camera follow it"({ page }) {
    await page.click('.drones [data-body="drone[7]"]');
    assert.deepEqual(await page.$$eval(".drones tr.chosen", (rows) => rows.map((row) => row.cells[0].textContent)), ["drone[7]"]);
  },
};

const ROBOT_TIMES = [0, 1, 2];

/** `bare` contains the pixels of the same run without the poses of its robots. */
const robotTests = (bare) => ({
  async "robots are drawn where they were recorded, and not without their poses"({ page }) {
    for (const time of ROBOT_TIMES) {
      const found = changedParts(await pixelsFromAbove(page, time), bare.get(time));
      assert.equal(found.length, 2, JSON.stringify(found));
      for (const robot of [1, 2]) {
        const [x, y] = ["x", "y"].map((axis) => valueAt("robots", `world.robot[${robot}].place.${axis}`, time));
        const heading = valueAt("robots", `world.robot[${robot}].heading`, time);
        const part = found.find(({ centre: [, v] }) => v > 0 === y > 0);
        // The roof is 0.3 m long and 0.24 m wide. The wheels are below it, inside these sides.
        assert.ok(Math.hypot(part.centre[0] - x, part.centre[1] - y) < 0.02, `robot ${robot} is at ${part.centre}, not ${[x, y]}`);
        const [cos, sin] = [Math.abs(Math.cos(heading)), Math.abs(Math.sin(heading))];
        const wanted = [0.3 * cos + 0.24 * sin, 0.3 * sin + 0.24 * cos];
        part.size.forEach((size, axis) => assert.ok(Math.abs(size - wanted[axis]) < 0.03, `robot ${robot} is ${part.size} large, not ${wanted}`));
      }
    }
  },
});

/** Shows a moment from above. Returns the pixels of the scene as numbers, with the place of a pixel on the roofs of robots [m]. The camera is above the
 * middle of the drone's path, at 1.35 times the scene's size, which is 2 m for a drone that does not move. */
async function pixelsFromAbove(page, time) {
  await setTime(page, time);
  await page.keyboard.press("3");
  await frame(page);
  await frame(page);
  const { width, height, pixels } = await page.evaluate(() => {
    const shown = document.querySelector("#scene");
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [shown.width, shown.height];
    const context = copy.getContext("2d");
    context.drawImage(shown, 0, 0);
    return { width: copy.width, height: copy.height, pixels: Array.from(new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer)) };
  });
  const [x, y, z] = ["x", "y", "z"].map((axis) => valueAt("robots", `world.drone[1].position.${axis}`, time));
  const metres = (2 * Math.tan((42 / 2) * (Math.PI / 180)) * (z + 1.35 * 2 - 0.12)) / height;
  return { width, height, pixels, metres, place: (column, row) => [x + (height / 2 - row) * metres, y + (width / 2 - column) * metres] };
}

/** Returns centre and size of the left and of the right half's pixels that differ. */
function changedParts(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  const halves = [true, false].map((left) => {
    const places = [];
    for (let i = 0; i < a.pixels.length; ++i) {
      const [column, row] = [i % a.width, Math.floor(i / a.width)];
      if (column < a.width / 2 === left && a.pixels[i] !== b.pixels[i]) places.push(a.place(column + 0.5, row + 0.5));
    }
    const range = (axis) => [Math.min(...places.map((place) => place[axis])), Math.max(...places.map((place) => place[axis]))];
    return places.length === 0 ? null : { ranges: [range(0), range(1)] };
  });
  return halves.filter(Boolean).map(({ ranges }) => ({ centre: ranges.map(([low, high]) => (low + high) / 2), size: ranges.map(([low, high]) => high - low + a.metres) }));
}

const chipReport = () => JSON.parse(readFileSync(join(runs, "chip.json"), "utf8"));
const close = (text, wanted) => assert.ok(Math.abs(numberOf(text) - wanted) <= 1e-3 * Math.abs(wanted), `${text}, not ${wanted}`);

const chipTests = {
  async "a line that the program printed has its time, and words of marks lie beside the shown time"({ page }) {
    const [time, end] = await page.evaluate(() => [window.mebots.runs[0].marks.find(({ text }) => text === "cluster: all right").time, window.mebots.clock.end]);
    assert.ok(time > 0.9 * end && time <= end, `${time} of ${end}`); // the program prints this message before its end
    const now = await page.$eval("#now", (one) => one.getBoundingClientRect().right);
    for (const left of await page.$$eval(".mark:not(.quiet) span", (all) => all.map((one) => one.getBoundingClientRect().left))) assert.ok(left >= now, `${left} < ${now}`);
  },

  async "the page of a program has the numbers of its report"({ page }) {
    const report = chipReport();
    const happened = await page.$eval(".story .happened", (text) => text.textContent);
    assert.match(happened, /^Ran [\d.]+ ms: exit 0; /);
    close(/exit 0; ([\d.]+ [mµn]?J)/.exec(happened)[1], report.chip_j);
    const rows = await page.$$eval(".chip .energy tbody tr", (found) => found.map((row) => [...row.cells].map((cell) => cell.textContent)));
    const used = Object.entries(report.parts_j).filter(([, joules]) => joules > 0);
    const sum = rows.findIndex(([name]) => name === "chip");
    assert.equal(sum, used.length);
    for (const [name, joules] of used) close(rows.find(([shown]) => shown === name.replaceAll("_", " "))[1], joules);
    close(rows[sum][1], report.chip_j);
    close(rows[sum][2], report.chip_mean_w);
    const text = await page.$eval(".chip", (part) => part.textContent);
    for (const cores of [report.controller, report.cluster]) {
      assert.ok(text.includes(cores.instructions.toLocaleString("en")) && text.includes((cores.cycles / cores.instructions).toFixed(3)), text);
    }
  },

  async "a core's clock is stated, in a row of the counts and in the sentence"({ page }) {
    const { controller, cluster } = await page.evaluate(() => window.mebots.runs[0].header.chip.clocks);
    assert.deepEqual(controller, { least_hz: 100e6, most_hz: 100e6, mean_hz: 100e6 }); // the program keeps the board's clock
    assert.deepEqual([cluster.least_hz, cluster.most_hz], [87e6, 100e6]); // the program sets both clocks
    assert.ok(cluster.mean_hz > 87e6 && cluster.mean_hz < 100e6);
    const cells = await page.$$eval(".chip tr", (rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
    const [, ...clocks] = cells.find(([name]) => name === "clock");
    assert.equal(numberOf(clocks[0]), controller.most_hz);
    assert.match(clocks[1], /^87\.00 MHz to 100\.0 MHz, in the mean 8[789]\.\d+ MHz$/);
    assert.match(await page.$eval(".story .happened", (text) => text.textContent), /controller at 100\.0 MHz:/);
  },

  async "power over time integrates to the energy of each part"({ page }) {
    const report = chipReport();
    for (const part of ["fc_background", "cluster_cores", "leakage"]) {
      const { mean, end } = await page.evaluate((name) => {
        const run = globalThis.mebots.runs[0];
        return { mean: run.curve({ rate_of: `chip.${name}` }).values(run.end)[1], end: run.end };
      }, part);
      assert.ok(Math.abs(mean * end - report.parts_j[part]) < 1e-9 * report.parts_j[part], part);
      assert.ok(Math.abs(end - report.time_s) < 1e-12);
    }
  },

  async "its functions have all cycles of all cores, and its lines the time at which they were printed"({ page }) {
    const report = chipReport();
    await page.click('[data-tab="Profile"]');
    const cycles = await page.evaluate(() => {
      const file = globalThis.mebots.runs[0].header.profiles[0];
      return file.mebots.windows.flatMap(({ parts }) => parts.filter((_, i) => i % 5 === 2)).reduce((sum, count) => sum + count, 0);
    });
    assert.equal(cycles, report.controller.cycles + report.cluster.cycles);
    const names = await page.$$eval(".functions tbody td:first-child", (found) => found.map((cell) => cell.textContent));
    assert.ok(names.includes("cluster_wait"), names.join(", "));
    await page.click('[data-tab="Messages"]');
    const lines = await page.$$eval(".messages tr", (found) => found.map((row) => row.textContent));
    assert.match(lines.find((line) => line.includes("cluster: all right")), /^[\d.]+ ms/);
  },
};

let failures = 0;
async function check(browser, file, cases, options) {
  const { page, problems, requests } = await open(browser, file, options);
  const every = {
    ...cases,
    async "nothing goes wrong on the page, and no request leaves the machine"() {
      assert.deepEqual(problems, []);
      assert.deepEqual(requests.filter((url) => !/^(file|blob|data):/.test(url)), []);
    },
  };
  for (const [name, run] of Object.entries(every)) {
    try {
      await run({ page });
      console.log(`ok    ${name}`);
    } catch (error) {
      ++failures;
      console.log(`FAIL  ${name}\n${error.stack}`);
    }
  }
  await page.close();
}

const browser = await launch(chromium);
try {
  await check(browser, pageOf("flight"), tests);
  await check(browser, pageOf("flight"), phoneTests, { width: 390, height: 844, dark: true, touch: true });
  await check(browser, pageOf("flight"), openingTests, { time: null });
  for (const run of ["flight", "system", "swarm"]) {
    await check(browser, pageOf(run), overlapTests, { width: 1440 });
    await check(browser, pageOf(run), overlapTests, { width: 390, height: 844, dark: true, touch: true });
  }
  await check(browser, pageOf("long"), longTests);
  await check(browser, pageOf("system"), systemTests);
  await check(browser, pageOf("system"), systemOnPhoneTests, { width: 390, height: 844, touch: true });
  await check(browser, join(runs, "beside.html"), besideTests);
  await check(browser, join(runs, "lengths.html"), lengthsTests);
  await check(browser, pageOf("swarm"), swarmTests);
  const { page: other } = await open(browser, pageOf("robots_not_recorded"));
  const bare = new Map();
  for (const time of ROBOT_TIMES) bare.set(time, await pixelsFromAbove(other, time));
  await other.close(); // a page in the background draws nothing
  await check(browser, pageOf("robots"), robotTests(bare));
  await check(browser, join(runs, "chip.html"), chipTests);
  const size = statSync(pageOf("flight")).size;
  if (size > 3e6) {
    ++failures;
    console.log(`FAIL  the page has ${size} bytes`);
  }
} finally {
  await browser.close();
}
process.exit(failures > 0 ? 1 : 0);
