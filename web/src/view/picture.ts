// SPDX-License-Identifier: Apache-2.0
// Shows the latest picture of the camera.
import type { Clock } from "../clock";
import type { Picture, Run } from "../data/run";
import { shownTime } from "../data/units";
import { element } from "../dom";

export function pictureAt(pictures: Picture[], time: number): Picture | null {
  let last: Picture | null = null;
  for (const picture of pictures) {
    if (picture.time > time + 1e-9) break;
    last = picture;
  }
  return last;
}

export function makePicture(run: Run, clock: Clock): HTMLElement {
  const image = element("img", { alt: "what the camera saw" });
  const caption = element("figcaption", {});
  const figure = element("figure", { class: "picture" }, image, caption);
  let shownUrl = "";
  const show = () => {
    const picture = pictureAt(run.pictures, clock.time);
    image.hidden = picture === null;
    caption.textContent = picture ? `camera at ${shownTime(picture.time)}${detail(run, picture)}` : "no picture yet";
    if (picture && picture.url !== shownUrl) image.src = shownUrl = picture.url;
  };
  clock.onTime(show);
  show();
  return figure;
}

/** Returns a note if the shown picture is smaller than the camera's picture: its size, and the share of pictures that
 * the page contains. Otherwise returns an empty text. */
function detail(run: Run, picture: Picture): string {
  const size = picture.shrunk > 1 ? `, 1/${picture.shrunk} size` : "";
  return picture.shrunk > 1 && run.pictureEvery > 1 ? `${size}, 1 of ${run.pictureEvery}` : size;
}
