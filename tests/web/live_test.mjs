// SPDX-License-Identifier: Apache-2.0
// Usage: live_test.mjs MEBOTS CONFIGS OUT [CHROMIUM]
// Compares a run that is viewed, paused and changed by hand with the same run without a viewer. The viewer is an HTTP client or a browser.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createServer, request } from "node:http";
import { join, resolve } from "node:path";

const [, , mebots, configs, out, chromium] = process.argv;
mkdirSync(out, { recursive: true });

/** A run that takes some seconds of wall time, so that it can be viewed. */
const system = join(out, "system.json");
writeFileSync(system, JSON.stringify({
  ...JSON.parse(readFileSync(join(configs, "battery_motors.json"), "utf8")),
  $schema: undefined, stop_time: 600, record: { interval: 0.1 },
}));

const results = (name) => readFileSync(join(out, name, "results.csv"), "utf8");

function runAlone(name, more = []) {
  const done = spawnSync(mebots, ["run", system, "--quiet", "--out", join(out, name), ...more], { encoding: "utf8" });
  assert.equal(done.status, 0, done.stderr);
}

/** Starts a live run. Returns its address, and a promise of its exit code. */
async function runLive(name, config = system, more = []) {
  return addressOf(spawn(mebots, ["run", config, "--out", join(out, name), ...more, "--live"], { stdio: ["ignore", "pipe", "inherit"] }));
}

async function addressOf(child) {
  const ended = once(child, "exit");
  let said = "";
  for await (const piece of child.stdout) {
    said += piece;
    const found = /^live: (http:\S+)$/m.exec(said);
    if (!found) continue;
    child.stdout.resume();
    return { address: new URL(found[1]), ended: ended.then(([code]) => code), child };
  }
  throw new Error(`it never said where: ${said}`);
}

/** Sends a request with arbitrary headers, which fetch() does not allow. */
function ask(address, path, { method = "GET", headers = {}, body = "" } = {}) {
  return new Promise((resolved, refused) => {
    const type = method === "POST" ? { "Content-Type": "application/x-www-form-urlencoded", "Content-Length": body.length } : {};
    const sent = request(new URL(path, address), { method, headers: { ...type, ...headers } }, async (answer) => {
      const pieces = [];
      for await (const piece of answer) pieces.push(piece);
      resolved({ status: answer.statusCode, text: Buffer.concat(pieces).toString() });
    });
    sent.on("error", refused);
    sent.end(body);
  });
}

const order = (live, what) => ask(live.address, "control", { method: "POST", body: `order=${encodeURIComponent(what)}` });
const set = (live, variable, value) => ask(live.address, "set", { method: "POST", body: `variable=${encodeURIComponent(variable)}&value=${value}` });

/** Returns the header of the data: identity and progress of the run. */
async function header(live, query = "") {
  const answer = await fetch(new URL(`data${query}`, live.address));
  const bytes = new DataView(await answer.arrayBuffer());
  return JSON.parse(new TextDecoder().decode(new Uint8Array(bytes.buffer, 4, bytes.getUint32(0, true))));
}

/** Forwards a browser's requests to the run. Calls `seen` with the path, the text and the status of each answered request. If `refusal`
 * returns a status for a path, answers the request with this status and does not forward it. */
async function forward(live, { seen = () => {}, refusal = () => null }) {
  const server = createServer(async (asked, answer) => {
    const pieces = [];
    for await (const piece of asked) pieces.push(piece);
    const status = refusal(asked.url);
    if (status) return answer.writeHead(status).end("refused");
    const headers = { ...asked.headers, host: live.address.host, connection: "close" };
    if (headers.origin) headers.origin = live.address.origin;
    const sent = request(new URL(asked.url, live.address), { method: asked.method, headers }, (got) => {
      answer.writeHead(got.statusCode, got.headers);
      got.pipe(answer);
      got.on("end", () => seen({ path: asked.url, text: Buffer.concat(pieces).toString(), status: got.statusCode }));
    });
    sent.on("error", () => answer.destroy());
    sent.end(Buffer.concat(pieces));
  });
  await once(server.listen(0, "127.0.0.1"), "listening");
  return { server, address: `http://127.0.0.1:${server.address().port}${live.address.pathname}` };
}

/** Polls the run until the condition holds, because a command takes effect between two steps. */
async function until(live, isSo) {
  for (const end = Date.now() + 20000; Date.now() < end; await new Promise((done) => setTimeout(done, 20))) {
    const run = (await header(live)).runs[0];
    if (isSo(run)) return run;
  }
  throw new Error("it was not so within 20 s");
}

/** Returns the number of steps of a paused run. Checks that several queries give the same number: a run answers between two steps, so
 * a run that is not paused would make a step before the next query. */
async function stoodAt(live) {
  const looks = [];
  for (let i = 0; i < 20; ++i) looks.push((await header(live)).runs[0].summary.steps);
  assert.deepEqual(new Set(looks), new Set([looks[0]]));
  return looks[0];
}

const overHttp = {
  async "who only looks changes no bit"() {
    runAlone("alone");
    const live = await runLive("looked_at");
    let over = false;
    const ended = live.ended.finally(() => { over = true; });
    let looks = 0;
    for (let known = ""; !over; await new Promise((done) => setTimeout(done, 20))) {
      try {
        const { rows, log } = (await header(live, known)).runs[0].live.known;
        known = `?rows=${rows}&pictures=0&log=${log}`; // like the page's request for new data
        ++looks;
      } catch {
        // The run has ended in the meantime. Its exit code shows the reason.
      }
    }
    const code = await ended;
    assert.equal(code, 0);
    assert.ok(looks > 3, `${looks} looks`);
    assert.equal(results("looked_at"), results("alone"));
  },

  async "a run that is held stands, takes single steps, and goes on to the same bits"() {
    const live = await runLive("held");
    assert.equal((await order(live, "hold")).status, 200);
    const before = await stoodAt(live);
    await order(live, "step");
    assert.equal((await until(live, (run) => run.summary.steps > before)).live.held, true);
    assert.equal(await stoodAt(live), before + 1);
    assert.equal((await order(live, "dance")).status, 400);
    await order(live, "go");
    assert.equal(await live.ended, 0);
    assert.equal(results("held"), results("alone"));
  },

  async "who has rows already gets what is new, in few bytes"() {
    const live = await runLive("news");
    await order(live, "hold");
    const size = async (query) => (await (await fetch(new URL(`data${query}`, live.address))).arrayBuffer()).byteLength;
    for (let i = 0; i < 400; ++i) await order(live, "step");
    const all = (await header(live)).runs[0];
    assert.ok(all.kept > 1 && all.kept === all.rows, `${all.kept} of ${all.rows} rows`);
    const query = `?rows=${all.rows}&pictures=0&log=${all.live.log}`;
    const nothing = (await header(live, query)).runs[0];
    assert.equal(nothing.kept, 0);
    assert.equal(nothing.log, "");
    assert.equal(nothing.system, null);
    assert.deepEqual(nothing.live.known, { rows: all.rows, pictures: 0, log: all.live.log });
    assert.ok((await size(query)) < 0.5 * (await size("")), "all is sent again");
    const one = (await header(live, `?rows=${all.rows - 1}&log=${all.live.log}`)).runs[0];
    assert.equal(one.kept, 1);
    assert.equal((await ask(live.address, "data?rows=many")).status, 400);
    await order(live, "go");
    assert.equal(await live.ended, 0);
    assert.equal(results("news"), results("alone"));
  },

  async "what was set by hand is a scenario that repeats the run to the bit"() {
    const live = await runLive("by_hand");
    await order(live, "hold");
    const settable = (await header(live)).runs[0].live.settable.map(({ variable }) => variable);
    assert.ok(settable.includes("motors.rotor[1].command"));
    assert.ok(!settable.includes("motors.bus.voltage"), "it is connected");
    assert.equal((await set(live, "motors.rotor[1].command", "0.3")).status, 200);
    const before = (await header(live)).runs[0].summary.steps;
    await order(live, "step");
    await until(live, (run) => run.summary.steps > before);
    assert.equal((await set(live, "motors.rotor[2].command", "0.7")).status, 200);
    for (const [variable, value] of [["motors.bus.voltage", "3"], ["motors.rotor[1].command", "7"], ["motors.rotor[1].command", "x"], ["motors.rotor[9].command", "0"]]) {
      assert.equal((await set(live, variable, value)).status, 400, `${variable} = ${value}`);
    }
    await order(live, "go");
    assert.equal(await live.ended, 0);
    assert.notEqual(results("by_hand"), results("alone"));
    runAlone("again", ["--scenario", join(out, "by_hand", "live_scenario.json")]);
    assert.equal(results("again"), results("by_hand"));
  },

  async "a run that is killed after values were set by hand resumes to the bits of an undisturbed run"() {
    const { step } = JSON.parse(readFileSync(system, "utf8"));
    const more = ["--live-start", "browser", "--checkpoint-every", String(4 * step), "--stop-time", String(40 * step)];
    const values = new Map([[1, "0.3"], [4, "0.5"], [5, "0.6"], [8, "0.4"]]); // by step; a checkpoint is written at steps 0, 4 and 8
    /** Makes single steps up to step `last`. Sets the values of `values` at their steps. */
    const stepTo = async (live, last) => {
      await order(live, "hold");
      for (let { steps } = (await header(live)).runs[0].summary; ; ++steps) {
        if (values.has(steps)) assert.equal((await set(live, "motors.rotor[1].command", values.get(steps))).status, 200);
        if (steps === last) return;
        await order(live, "step");
        await until(live, (run) => run.summary.steps > steps);
      }
    };
    const undisturbed = await runLive("undisturbed", system, more);
    await stepTo(undisturbed, 9);
    await order(undisturbed, "go");
    assert.equal(await undisturbed.ended, 0);
    const killed = await runLive("killed", system, more);
    await stepTo(killed, 6);
    killed.child.kill("SIGKILL");
    await killed.ended;
    const resumed = await addressOf(spawn(mebots, ["resume", join(out, "killed"), "--live", "--live-start", "browser"], { stdio: ["ignore", "pipe", "inherit"] }));
    await order(resumed, "hold"); // the header counts as a browser, for which the run waits
    assert.equal((await header(resumed)).runs[0].summary.steps, 5, "it resumes from the checkpoint at step 4, and makes one step");
    values.delete(5); // the resumed run sets it again
    await stepTo(resumed, 8);
    resumed.child.kill("SIGKILL");
    await resumed.ended;
    const done = spawnSync(mebots, ["resume", join(out, "killed"), "--quiet"], { encoding: "utf8" });
    assert.equal(done.status, 0, done.stderr);
    assert.equal(results("killed"), results("undisturbed"));
    for (const file of ["log.txt", "live_scenario.json"]) {
      assert.equal(readFileSync(join(out, "killed", file), "utf8"), readFileSync(join(out, "undisturbed", file), "utf8"));
    }
    const summary = (name) => ({ ...JSON.parse(readFileSync(join(out, name, "summary.json"), "utf8")), wall_clock: 0, real_time_factor: 0, resumed_at: 0 });
    assert.deepEqual(summary("killed"), summary("undisturbed"));
    assert.equal(summary("killed").inputs.writes.length, 4);
    const own = spawnSync(mebots, ["run", system, "--out", join(out, "killed"), "--scenario", join(out, "killed", "live_scenario.json")], { encoding: "utf8" });
    assert.equal(own.status, 2);
    assert.match(own.stderr, /would replace this file, its scenario, with its own live_scenario.json/);
    runAlone("killed", ["--stop-time", String(4 * step)]);
    assert.ok(!existsSync(join(out, "killed", "live_scenario.json")), "a new run in the folder has no values set by hand");
  },

  async "it may wait for a browser, and then gives the same bits"() {
    const live = await runLive("awaited", system, ["--live-start", "browser"]);
    await new Promise((done) => setTimeout(done, 500));
    assert.equal((await header(live)).runs[0].summary.steps, 1); // after this step inputs can be set
    assert.equal(await live.ended, 0);
    assert.equal(results("awaited"), results("alone"));
  },

  async "it keeps to a pace, which can change on the way"() {
    runAlone("short", ["--stop-time", "300"]);
    const start = Date.now();
    const live = await runLive("paced", system, ["--stop-time", "300", "--live-pace", "100"]);
    assert.equal((await header(live)).runs[0].live.pace, 100);
    assert.equal((await order(live, "pace=fast")).status, 400);
    assert.equal((await order(live, "pace=-1")).status, 400);
    await until(live, (run) => run.summary.simulated_time >= 100);
    assert.ok(Date.now() - start > 990, `${Date.now() - start} ms for 100 s at 100 times real time`);
    assert.equal((await order(live, "pace=0")).status, 200);
    assert.equal(await live.ended, 0);
    assert.equal(results("paced"), results("short"));
  },

  async "the page stays until Ctrl-C with complete results"() {
    const live = await runLive("kept", system, ["--live-keep"]);
    await until(live, (run) => run.live.ended);
    assert.equal(results("kept"), results("alone"));
    await new Promise((done) => setTimeout(done, 3500)); // longer than a page usually remains
    assert.equal((await header(live)).runs[0].summary.outcome, "completed");
    live.child.kill("SIGINT");
    assert.equal(await live.ended, 0);
  },

  async "the run waits at its end for each open page that is slow, until it has the last rows or closes"() {
    const live = await runLive("slow_pages", system, ["--stop-time", "1", "--live-start", "browser"]);
    await order(live, "hold");
    for (const page of ["slow", "closed"]) await header(live, `?page=${page}`);
    let over = false;
    live.ended.finally(() => { over = true; });
    await order(live, "go");
    await until(live, (run) => run.live.ended); // this client is no page: the run waits for others
    await new Promise((done) => setTimeout(done, 3500)); // longer than it waits for a client that is no page
    assert.equal(over, false);
    assert.equal((await header(live, "?page=slow")).runs[0].live.ended, true);
    await new Promise((done) => setTimeout(done, 300));
    assert.equal(over, false);
    assert.equal((await order(live, "leave=closed")).status, 200);
    assert.equal(await live.ended, 0);
  },

  async "a run that is resumed can be looked at, too"() {
    const cut = await runLive("resumed", system, ["--checkpoint-every", "10", "--live-pace", "1000"]);
    await until(cut, (run) => run.summary.simulated_time > 30);
    cut.child.kill("SIGINT");
    assert.equal(await cut.ended, 1);
    const child = spawn(mebots, ["resume", join(out, "resumed"), "--live", "--live-keep"], { stdio: ["ignore", "pipe", "inherit"] });
    const live = await addressOf(child);
    await until(live, (run) => run.live.ended);
    live.child.kill("SIGINT");
    assert.equal(await live.ended, 0);
    assert.equal(results("resumed"), results("alone"));
  },

  async "strangers are refused: without the token, under another host's name, from another page"() {
    const live = await runLive("refused");
    await order(live, "hold");
    const root = new URL("/", live.address);
    assert.equal(live.address.hostname, "127.0.0.1");
    assert.match(live.address.pathname, /^\/[0-9a-f]{32}\/$/);
    assert.equal((await ask(root, "/")).status, 403);
    assert.equal((await ask(root, "/data")).status, 403);
    assert.equal((await ask(root, `/${"0".repeat(32)}/data`)).status, 403);
    assert.equal((await ask(live.address, "data", { headers: { Host: "evil.example" } })).status, 403);
    assert.equal((await ask(live.address, "data", { headers: { Origin: "http://evil.example" } })).status, 403);
    assert.equal((await ask(live.address, "control", { method: "POST", headers: { Origin: "null" }, body: "order=go" })).status, 403);
    assert.equal((await ask(live.address, "data", { headers: { Origin: live.address.origin } })).status, 200);
    live.child.kill("SIGINT");
    assert.equal(await live.ended, 1); // interrupted while it was paused
  },
};

const inTheBrowser = {
  async "a page that closes says so, and the run does not wait for it"() {
    const { launch, openUrl } = await import("./browser.mjs");
    const browser = await launch(chromium);
    const live = await runLive("closed_page", system, ["--stop-time", "1", "--live-start", "browser"]);
    let name = null;
    let leave;
    const left = new Promise((done) => { leave = done; });
    const { server, address } = await forward(live, { seen: ({ path, text, status }) => {
      name ??= /[?&]page=(\d+)/.exec(path)?.[1] ?? null;
      const given = new URLSearchParams(text).get("order");
      if (given?.startsWith("leave=")) leave({ order: given, status });
    } });
    try {
      await order(live, "hold");
      const { page, problems } = await openUrl(browser, address);
      assert.deepEqual(problems, []);
      await page.close();
      const late = new Promise((_, fail) => setTimeout(() => fail(new Error("the page did not say that it closes")), 60000).unref());
      assert.deepEqual(await Promise.race([left, late]), { order: `leave=${name}`, status: 200 });
      const start = Date.now();
      await order(live, "go");
      assert.equal(await live.ended, 0);
      assert.ok(Date.now() - start < 25000, `${Date.now() - start} ms`); // it waits 30 s for a page that is open
    } finally {
      live.child.kill();
      await browser.close();
      server.close();
    }
  },

  async "a page tries again while the run is busy, also when it opens, and no longer if it is refused"() {
    const { launch, openUrl } = await import("./browser.mjs");
    const browser = await launch(chromium);
    const live = await runLive("busy");
    let refused = 503;
    let asked = 0;
    const { server, address } = await forward(live, { refusal: (path) => {
      if (!path.includes("/data?")) return null;
      if (++asked === 3) refused = null;
      return refused;
    } });
    try {
      await order(live, "hold");
      const { page, problems } = await openUrl(browser, address);
      assert.deepEqual(problems.filter((text) => !text.includes("503")), []);
      const says = (text) => page.waitForFunction((what) => document.getElementById("live").textContent.includes(what), { timeout: 60000 }, text);
      refused = 503;
      await says("waiting for the run");
      refused = null;
      await says("held");
      refused = 403;
      await says("no longer responds");
      const last = asked;
      await new Promise((done) => setTimeout(done, 1500)); // more than three times the page's period
      assert.equal(asked, last);
    } finally {
      live.child.kill();
      await browser.close();
      server.close();
    }
  },

  async "the page follows a flight, holds it, and shows its end"() {
    const { launch, openUrl } = await import("./browser.mjs");
    const browser = await launch(chromium); // may take longer than the flight
    const live = await runLive("flight", resolve(configs, "gate_easy.json"), ["--stop-time", "20"]); // long enough to
                                                                                                     // be observed
    try {
      await order(live, "hold");
      const { page, problems, requests } = await openUrl(browser, live.address.href);
      assert.deepEqual(problems, []);
      const time = () => page.evaluate(() => globalThis.mebots.clock.time);
      const stood = await time();
      await page.waitForFunction(() => document.getElementById("live").textContent === "held", { timeout: 10000 });
      await page.click("#hold");
      await page.waitForFunction((before) => globalThis.mebots.clock.time > before, { timeout: 60000 }, stood);
      await page.waitForFunction(() => document.getElementById("live").textContent === "ended", { timeout: 300000 });
      assert.equal(await time(), 20);
      // The data that arrived in parts equal the results.
      const [head, ...lines] = results("flight").trim().split("\n");
      for (const name of ["world.drone.position.z", "battery.cell.voltage", "soc.camera.trigger", "world.drone.phase"]) {
        const place = head.split(",").findIndex((title) => title.startsWith(`${name} [`));
        const shown = await page.evaluate((which) => [...globalThis.mebots.runs[0].values(which)], name);
        assert.deepEqual(shown, lines.map((line) => Number(line.split(",")[place])), name);
      }
      assert.ok(await page.evaluate(() => globalThis.mebots.runs[0].pictures.length) >= 1);
      assert.ok(await page.$("#scene"));
      assert.deepEqual(problems, []);
      assert.deepEqual(requests.filter((url) => !url.startsWith(live.address.href) && !/^(blob|data):/.test(url)), []);
    } finally {
      await browser.close();
    }
    assert.equal(await live.ended, 0);
  },
};

if (chromium?.endsWith("NOTFOUND")) {
  console.log("there is no Chromium; scripts/setup.sh installs it");
  process.exit(77);
}
let failures = 0;
for (const [name, run] of Object.entries(chromium ? inTheBrowser : overHttp)) {
  try {
    await run();
    console.log(`ok    ${name}`);
  } catch (error) {
    ++failures;
    console.log(`FAIL  ${name}\n${error.stack}`);
  }
}
process.exit(failures > 0 ? 1 : 0);
