// SPDX-License-Identifier: Apache-2.0
// Usage: node picture.mjs PAGE.html OUT.png [time=S] [look=follow|free|top|onboard] [tab=NAME] [dark=1] [width=PX] [height=PX]
// A page as a picture, by Debian's Chromium; with OUT.mp4 and fps=N a film of all of it, by ffmpeg.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { launch, open } from "../tests/web/browser.mjs";

const [, , file, out, ...settings] = process.argv;
const { time, look, tab, dark, width = 1400, height = 900, fps = "15", speed = "1" } = Object.fromEntries(settings.map((each) => each.split("=")));
if (!out) throw new Error("usage: node picture.mjs PAGE.html OUT.png|OUT.mp4 [time=S] [look=...] [tab=NAME] [dark=1] [width=PX] [height=PX]");

const setTime = (page, moment) => page.evaluate((t) => new Promise((done) => {
  globalThis.mebots.clock.set(t);
  requestAnimationFrame(() => requestAnimationFrame(() => done()));
}), moment);

const browser = await launch(process.env.CHROMIUM ?? "/usr/bin/chromium");
try {
  const { page, problems } = await open(browser, file, { width: Number(width), height: Number(height), dark: dark === "1" });
  if (problems.length > 0) throw new Error(problems.join("\n"));
  if (look) await page.click(`.tools button:nth-child(${1 + ["follow", "free", "top", "onboard"].indexOf(look)})`);
  if (tab) await page.click(`[data-tab="${tab}"]`);
  if (out.endsWith(".mp4")) {
    const film = spawn("ffmpeg", ["-y", "-loglevel", "error", "-f", "image2pipe", "-framerate", fps, "-i", "-", "-pix_fmt", "yuv420p", "-crf", "26", out],
      { stdio: ["pipe", "inherit", "inherit"] });
    const end = await page.evaluate(() => globalThis.mebots.clock.end);
    for (let moment = 0; moment <= end; moment += speed / fps) {
      await setTime(page, moment);
      if (!film.stdin.write(await page.screenshot({ type: "jpeg", quality: 92 }))) await once(film.stdin, "drain");
    }
    film.stdin.end();
    const [code] = await once(film, "exit");
    if (code !== 0) throw new Error(`ffmpeg ended with ${code}`);
  } else {
    await setTime(page, Number(time ?? 0));
    await page.evaluate(() => Promise.all([...document.images].map((image) => image.decode().catch(() => {}))));
    await setTime(page, Number(time ?? 0)); // with the picture on the scene's screen
    await page.screenshot({ path: out });
  }
} finally {
  await browser.close();
}
