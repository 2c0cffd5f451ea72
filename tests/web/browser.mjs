// SPDX-License-Identifier: Apache-2.0
// Opens a page from the disk in Debian's Chromium without network, and records the page's requests, messages and
// errors.
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../web/package.json", import.meta.url));
const puppeteer = require("puppeteer-core");

export async function launch(chromium) {
  return puppeteer.launch({
    executablePath: chromium,
    headless: true,
    protocolTimeout: 120000,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
      "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
  });
}

/** Opens a page and waits until it has drawn everything. Adds errors to `problems`, and the page's requests to `requests`. `prepare` runs in the page
 * before its scripts. */
export async function openUrl(browser, url, { width = 1400, height = 900, dark = false, touch = false, prepare = () => {} } = {}) {
  const page = await browser.newPage();
  await page.evaluateOnNewDocument(prepare);
  const problems = [];
  const requests = [];
  page.on("pageerror", (error) => problems.push(`error: ${error.message}`));
  page.on("console", (message) => {
    if (message.type() === "error") problems.push(`console: ${message.text()}`);
  });
  page.on("request", (request) => requests.push(request.url()));
  await page.setViewport({ width, height, deviceScaleFactor: 1, hasTouch: touch });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }]);
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.state !== "loading", { timeout: 60000 });
  const state = await page.evaluate(() => document.documentElement.dataset.state);
  if (state !== "ready") problems.push(`the page is ${state}: ${await page.evaluate(() => document.body.innerText)}`);
  return { page, problems, requests };
}

/** Opens a page on the disk at a time of the run; if `time` is null, without a time. Otherwise works as openUrl(). */
export const open = (browser, file, { time = 0, ...options } = {}) =>
  openUrl(browser, pathToFileURL(file).href + (time === null ? "" : `#t=${time}`), options);
