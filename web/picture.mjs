// SPDX-License-Identifier: Apache-2.0
// Usage: node picture.mjs PAGE.html OUT.png [time=S] [from=S to=S] [look=follow|free|top|onboard] [tab=NAME] [dark=1] [width=PX] [height=PX]
// Writes a picture of a page. Uses Debian's Chromium. Only the page of a run has times, cameras and tabs.
import { launch, open } from "../tests/web/browser.mjs";

const [, , file, out, ...settings] = process.argv;
const { time, from, to, look, tab, dark, width = 1400, height = 900 } = Object.fromEntries(settings.map((each) => each.split("=")));
if (!out) throw new Error("usage: node picture.mjs PAGE.html OUT.png [time=S] [from=S to=S] [look=...] [tab=NAME] [dark=1] [width=PX] [height=PX]");

const setTime = (page, moment) => page.evaluate((t) => new Promise((done) => {
  globalThis.mebots.clock?.set(t);
  requestAnimationFrame(() => requestAnimationFrame(() => done()));
}), moment);

const browser = await launch(process.env.CHROMIUM ?? "/usr/bin/chromium");
try {
  const { page, problems } = await open(browser, file, { width: Number(width), height: Number(height), dark: dark === "1" });
  if (problems.length > 0) throw new Error(problems.join("\n"));
  if (look) await page.click(`.tools button:nth-child(${1 + ["follow", "free", "top", "onboard"].indexOf(look)})`);
  if (from) await page.evaluate((a, b) => globalThis.mebots.span.set(a, b), Number(from), Number(to));
  if (tab) await page.click(`[data-tab="${tab}"]`);
  await setTime(page, Number(time ?? 0));
  await page.evaluate(() => Promise.all([...document.images].map((image) => image.decode().catch(() => {}))));
  await setTime(page, Number(time ?? 0)); // including the picture on the scene's screen
  await page.screenshot({ path: out });
} finally {
  await browser.close();
}
