// SPDX-License-Identifier: Apache-2.0
// Follows a run in progress: fetches new data, pauses the run and sets inputs. The server is in master/live.
import type { Clock } from "./clock";
import { type Payload, readPayload } from "./data/payload";
import type { Run } from "./data/run";
import { shownTime, shownUnit } from "./data/units";
import { dotted, element } from "./dom";
import type { Window } from "./view/window";

/** The time between two requests [ms]. */
const PERIOD = 400;
/** The HTTP status of a run that cannot send data now. */
const BUSY = 503;
/** Paces that the page offers, in multiples of real time. 0 means as fast as possible. */
const PACES = [0, 0.1, 0.5, 1, 2, 5, 10];

/** Identifies this page to the run. Before it exits, the run waits until all open pages have the last data. */
const PAGE = String(Math.random()).slice(2);

/** Thrown if the run cannot send data now, because its current step takes long. */
class Busy extends Error {}

/** Fetches all data. While the run is busy, repeats the request. From then on, the run counts this page as open until
 * the page closes. */
export async function fetchAll(): Promise<Payload> {
  addEventListener("pagehide", () => navigator.sendBeacon("control", new URLSearchParams({ order: `leave=${PAGE}` })));
  for (;;) {
    try {
      return await fetchPayload();
    } catch (error) {
      if (!(error instanceof Busy)) throw error;
    }
    await new Promise((done) => setTimeout(done, PERIOD));
  }
}

/** Fetches the data that this page lacks. By default, these are all data. */
async function fetchPayload(known = { rows: 0, pictures: 0, log: 0 }): Promise<Payload> {
  const answer = await fetch(`data?rows=${known.rows}&pictures=${known.pictures}&log=${known.log}&page=${PAGE}`);
  if (answer.status === BUSY) throw new Busy(await answer.text());
  if (!answer.ok) throw new Error(await answer.text());
  return readPayload(new Uint8Array(await answer.arrayBuffer()));
}

async function post(path: string, values: Record<string, string>): Promise<string> {
  const answer = await fetch(path, { method: "POST", body: new URLSearchParams(values) });
  const text = await answer.text();
  if (!answer.ok) throw new Error(text);
  return text;
}

/** Fetches new data of the run and updates the page. If the page shows the last time, moves it to the new last time.
 * Returns the controls. */
export function follow(run: Run, clock: Clock, span: Window): HTMLElement {
  const badge = element("span", { class: "outcome", id: "live" }, "live");
  const hold = element("button", { id: "hold", onclick: () => void order(run.header.live?.held ? "go" : "hold") });
  const step = element("button", { id: "step", title: "Advance by one communication step", onclick: () => void order("step") }, "step");
  const pace = element("select", { id: "pace", title: "Simulated seconds per second", "aria-label": "pace", onchange: () => void order(`pace=${pace.value}`) },
    ...PACES.map((one) => element("option", { value: String(one) }, one === 0 ? "full speed" : `${one}\u00d7`)));
  const order = async (what: string) => {
    await post("control", { order: what }).then(look).catch((error) => (badge.textContent = String(error)));
  };
  const show = () => {
    const state = run.header.live;
    badge.textContent = state?.ended ? "ended" : state?.held ? "held" : "live";
    hold.textContent = state?.held ? "continue" : "hold";
    hold.disabled = step.disabled = pace.disabled = state?.ended ?? false;
    const value = String(state?.pace ?? 0);
    if (![...pace.options].some((one) => one.value === value)) pace.append(element("option", { value }, `${value}\u00d7`));
    if (document.activeElement !== pace) pace.value = value;
  };
  // Sends one request at a time. The replies to two simultaneous requests would contain the same rows.
  let looking: Promise<void> = Promise.resolve();
  const look = () => (looking = looking.catch(() => {}).then(lookOnce));
  const lookOnce = async () => {
    if (run.header.live?.ended) return;
    const payload = await fetchPayload(run.isLong ? undefined : run.known);
    const isFollowing = clock.time >= clock.end - 1e-9;
    run.goOn(payload.runs[0], payload);
    clock.extend(run.end);
    run.tell();
    span.extend(clock.end);
    clock.set(isFollowing ? clock.end : clock.time);
    show();
  };
  const keepLooking = async () => {
    try {
      await look().catch((error) => {
        if (!(error instanceof Busy)) throw error;
        badge.textContent = "waiting for the run";
      });
      if (run.header.live?.ended) return;
      setTimeout(keepLooking, PERIOD);
    } catch {
      badge.textContent = `the run no longer responds; the page shows it up to ${shownTime(run.end)}`;
    }
  };
  show();
  setTimeout(keepLooking, PERIOD);
  return element("span", { class: "live" }, badge, " ", hold, " ", step, " ", pace);
}

/** Creates controls for unconnected inputs. The run records settings as a scenario, so that it can be repeated. */
export function makeInputs(run: Run): HTMLElement {
  const said = element("p", { class: "faint" }, "A value takes effect at the next step. The results folder records all values in live_scenario.json.");
  const rows = (run.header.live?.settable ?? []).map(({ variable, unit, text, type }) => {
    const value = element("input", { type: "number", step: "any", "data-set": variable, "aria-label": variable });
    const send = async () => {
      try {
        const { at } = JSON.parse(await post("set", { variable, value: value.value }));
        said.textContent = `${variable} is ${value.value} ${shownUnit(unit)} from ${at} s on`;
      } catch (error) {
        said.textContent = String(error instanceof Error ? error.message : error);
      }
    };
    value.addEventListener("keydown", (event) => event.key === "Enter" && void send());
    return element("tr", {}, element("td", {}, ...dotted(variable)), element("td", { class: "whole" }, value, ` ${shownUnit(unit) || (type === "Real" ? "" : type)} `,
      element("button", { onclick: () => void send() }, "set")), element("td", { class: "faint" }, text));
  });
  return element("div", { class: "inputs scroll" }, said, element("table", {}, element("tbody", {}, ...rows)));
}
