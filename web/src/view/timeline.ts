// SPDX-License-Identifier: Apache-2.0
// The bottom of the page: play, speed, the shown time, and a line of the whole run with its marks.
import type { Clock } from "../clock";
import type { Message } from "../data/messages";
import { shortText } from "../data/messages";
import type { Run } from "../data/run";
import { shownTime } from "../data/units";
import { element } from "../dom";
import { makeScrubbable } from "./scrub";
import { Window } from "./window";

const MARGIN = 24; // pixels between the text of the shown time and the line, as in page.css
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

export function makeTimeline(run: Run, clock: Clock, window: Window): HTMLElement {
  const play = element("button", { class: "play", title: "Play or pause (space)", "aria-label": "play", onclick: () => clock.toggle() });
  const speed = element("select", { title: "Speed (+ and \u2212)", "aria-label": "speed" });
  for (const value of SPEEDS) speed.append(element("option", { value: String(value) }, `${value}\u00d7`));
  speed.addEventListener("change", () => clock.setSpeed(Number(speed.value)));
  const now = element("output", { class: "now", id: "now" });
  const track = element("div", { class: "track", role: "slider", tabindex: "0", "aria-label": "moment", "aria-valuemin": "0", "aria-valuemax": String(clock.end) });
  const shownSpan = element("div", { class: "span" });
  const pointed = element("div", { class: "pointed" });
  const done = element("div", { class: "done" });
  const knob = element("div", { class: "knob" });
  const markArea = element("div", { class: "marks" });
  track.append(element("div", { class: "rail" }), shownSpan, done, markArea, pointed, knob);
  const whole = new Window(clock.end);
  makeScrubbable(track, clock, window, { drag: "moves", along: whole });
  const showMarks = () => {
    const marks = run.marks;
    const counts = new Map<string, number>();
    for (const mark of marks) counts.set(keyOf(mark), (counts.get(keyOf(mark)) ?? 0) + 1);
    const tags = marks.map((mark) => makeMark(mark, counts.get(keyOf(mark))!, clock));
    markArea.replaceChildren(...tags);
    keepApart(tags, track.getBoundingClientRect().left - MARGIN);
  };
  new ResizeObserver(showMarks).observe(track);
  run.onData(() => {
    whole.extend(clock.end);
    showMarks();
  });
  const showTime = () => {
    const share = clock.end > 0 ? 100 * (clock.time / clock.end) : 0;
    now.textContent = `${shownTime(clock.time)} / ${shownTime(clock.end)}`;
    done.style.width = knob.style.left = `${share}%`;
    track.setAttribute("aria-valuenow", clock.time.toFixed(3));
  };
  const showState = () => {
    play.textContent = clock.isPlaying ? "\u275a\u275a" : "\u25b6";
    speed.value = String(clock.speed);
  };
  const showSpan = () => {
    shownSpan.hidden = window.isWhole;
    shownSpan.style.left = `${(100 * window.start) / clock.end}%`;
    shownSpan.style.width = `${(100 * (window.stop - window.start)) / clock.end}%`;
  };
  clock.onTime(showTime);
  clock.onState(showState);
  window.onChange(showSpan);
  window.onPoint(() => {
    pointed.style.display = window.pointed === null ? "none" : "block";
    pointed.style.left = `${(100 * (window.pointed ?? 0)) / (clock.end || 1)}%`;
  });
  showTime();
  showState();
  showSpan();
  return element("footer", { class: "timeline" }, play, speed, now, track);
}

/** Hides the text of a mark that would overlap an earlier text. Also hides warnings, which are long. Hidden texts
 * appear under the pointer. */
function keepApart(marks: HTMLElement[], first: number): void {
  let end = -Infinity;
  for (const mark of marks) {
    const words = mark.firstElementChild as HTMLElement;
    mark.classList.remove("quiet");
    words.style.marginLeft = "";
    const box = words.getBoundingClientRect();
    const over = Math.max(0, box.right + 4 - innerWidth); // pixels of the text beyond the right edge of the page
    const under = Math.max(0, first - box.left); // pixels of the text that would cover the shown time
    const quiet = box.left - over + under < end + 8 || mark.classList.contains("warning");
    mark.classList.toggle("quiet", quiet);
    if (quiet) continue;
    words.style.marginLeft = `${under - over}px`;
    end = box.right - over + under;
  }
}

export function nextSpeed(speed: number, direction: number): number {
  const place = SPEEDS.findIndex((candidate) => candidate >= speed);
  return SPEEDS[Math.min(Math.max(place + direction, 0), SPEEDS.length - 1)];
}

/** Splits the text of an event, such as "drone[3]: t = 0.1 s: take-off", into the body's name and the event. Without a
 * name, `who` is empty. */
function partsOf(message: Message): { who: string; what: string } {
  const [, who, rest] = /^(\w+\[\d+\]): (.*)$/s.exec(message.text) ?? [null, "", message.text];
  return { who, what: shortText({ ...message, text: rest }).split(/[:;,]/)[0] };
}

/** Returns a key that is equal for events of several bodies with the same text at the same time. For an event without a
 * body, returns an empty text. */
function keyOf(message: Message): string {
  const { who, what } = partsOf(message);
  return who === "" ? "" : `${message.time} ${what}`;
}

/** Creates the mark of an event that `count` bodies have. */
function makeMark(message: Message, count: number, clock: Clock): HTMLElement {
  const { who, what } = partsOf(message);
  const words = who === "" ? what : count > 1 ? `${count} \u00d7 ${what}` : `${who}: ${what}`;
  const mark = element("button", {
    class: `mark ${message.severity}`,
    title: `${shownTime(message.time!)} · ${message.instance}: ${message.text}`,
    "aria-label": message.text,
    onclick: () => clock.set(message.time!),
    onpointerdown: (event) => event.stopPropagation(),
  }, element("span", {}, words));
  mark.style.left = `${clock.end > 0 ? (100 * message.time!) / clock.end : 0}%`;
  return mark;
}
