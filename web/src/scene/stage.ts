// SPDX-License-Identifier: Apache-2.0
// Draws the scene on its canvas. Contains the buttons for the views (follow, free, top, on board), and the legend of
// the path's colours.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Clock } from "../clock";
import type { Json } from "../data/payload";
import { type Run, rowAt } from "../data/run";
import { shown } from "../data/units";
import { element } from "../dom";
import { colour, onTheme, scaleColour, styleColour } from "../theme";
import { pictureAt } from "../view/picture";
import { Body } from "./body";
import { Path } from "./path";
import { Surfaces } from "./surfaces";

/** The factor of the brightness in outside views. The view from on board has the brightness of the camera's picture. */
const EXPOSURE = 1.2;

/** Target and position, relative to the body [m], of the camera that follows the drone. The target is low and far
 * ahead, so that the space in front of the drone is visible. */
const AHEAD = new THREE.Vector3(0.42, 0, 0.14);
const BEHIND = new THREE.Vector3(-0.85, -0.36, 0.36);

export type Look = "follow" | "free" | "top" | "onboard";
export const LOOKS: Look[] = ["follow", "free", "top", "onboard"];

/** A variable for the path's colour, one number per row. */
export interface PathColour {
  label: string;
  unit: string;
  values(): Float64Array;
}

interface Flight {
  run: Run;
  name: string;
  body: Body;
  path: Path;
}

export class Stage {
  readonly root = element("div", { class: "stage" });
  private readonly canvas = element("canvas", { id: "scene", "aria-label": "the flight in space" });
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(42, 1, 0.01, 200);
  private readonly controls: OrbitControls;
  private readonly surfaces: Surfaces;
  private readonly background: THREE.Color; // what its camera sees in the background
  private readonly flights: Flight[] = [];
  private readonly labels: { place: THREE.Vector3; tag: HTMLElement }[] = [];
  private readonly plumb: THREE.Line;
  private readonly ring = element("div", { class: "ring" });
  private readonly legend = element("div", { class: "legend" });
  private readonly eyeTag = element("div", { class: "tag small" }, "camera's view");
  private readonly textures = new Map<string, THREE.Texture>();
  private readonly buttons = new Map<Look, HTMLButtonElement>();
  private look: Look = "follow";
  private readonly followed = new THREE.Vector3(); // where the body was when the camera followed it last
  private asked = false;
  private chosenColour = 0;
  private chosen = 0; // of the bodies of one run; with several runs the first
  private readonly choiceListeners: (() => void)[] = [];
  private readonly firstDrawn: Promise<void>;
  private tellDrawn = () => {};

  constructor(runs: Run[], private readonly clock: Clock, private readonly colours: PathColour[]) {
    THREE.ColorManagement.enabled = false;
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // greys as the camera has them
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const info = runs[0].scene as Json;
    this.background = new THREE.Color().setScalar((info.background ?? 0) / 255);
    this.surfaces = new Surfaces(info, runs[0]);
    this.scene.add(this.surfaces.group);
    runs.forEach((run, i) => this.addFlight(run, i, runs.length));
    this.plumb = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineDashedMaterial({ color: colour(0), dashSize: 0.04, gapSize: 0.03, transparent: true, opacity: 0.8 }),
    );
    this.plumb.frustumCulled = false;
    this.scene.add(this.plumb);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.ask());
    this.controls.addEventListener("start", () => {
      if (this.look === "top" || this.look === "onboard") this.setLook("free");
    });
    for (const label of info.labels ?? []) {
      const tag = element("div", { class: "tag" }, label.text);
      this.labels.push({ place: new THREE.Vector3(...(label.position as [number, number, number])), tag });
    }
    this.root.append(this.canvas, this.ring, this.eyeTag, ...this.labels.map((label) => label.tag), this.makeTools(), this.legend);
    this.firstDrawn = new Promise((resolve) => (this.tellDrawn = resolve));
    new ResizeObserver(() => this.resize()).observe(this.root);
    clock.onTime(() => this.showMoment());
    onTheme(() => this.ask());
    this.setColour(0);
    this.setLook(this.hasManyBodies ? "free" : "follow");
  }

  /** Resolves after the first drawing of the scene. */
  get ready(): Promise<void> {
    return this.firstDrawn;
  }

  setLook(look: Look): void {
    this.look = look;
    for (const [name, button] of this.buttons) button.setAttribute("aria-pressed", String(name === look));
    const place = this.flight.body.position(this.clock.time);
    const bounds = new THREE.Box3();
    for (const { body } of this.hasManyBodies ? this.flights : [this.flight]) bounds.union(new THREE.Box3().setFromArray(Array.from(body.path())));
    for (const label of this.labels) bounds.expandByPoint(label.place);
    const middle = bounds.getCenter(new THREE.Vector3());
    const size = bounds.getSize(new THREE.Vector3());
    const span = Math.max(2, size.length());
    if (look === "follow") {
      this.controls.target.copy(place).add(AHEAD);
      this.followed.copy(place);
      this.camera.position.copy(place).add(BEHIND);
    } else if (look === "free") {
      this.controls.target.copy(middle);
      // From the south, a row of bodies along y would be small.
      const offset = this.hasManyBodies && size.y > 2 * size.x ? new THREE.Vector3(-0.75, -0.2, 0.45) : new THREE.Vector3(-0.35, -0.85, 0.62);
      this.camera.position.copy(middle).add(offset.multiplyScalar(span));
      // The list of bodies covers the bottom of the picture. Therefore the camera looks at a lower point, but not at a
      // point below the ground.
      if (this.hasManyBodies) this.controls.target.z = Math.max(middle.z - 0.08 * span, Math.min(middle.z, 0.05));
    } else if (look === "top") {
      this.controls.target.copy(middle);
      this.camera.position.copy(middle).add(new THREE.Vector3(-0.001, 0, 1.35 * span));
    }
    this.controls.enabled = look !== "onboard";
    this.showMoment();
  }

  nextLook(): void {
    this.setLook(LOOKS[(LOOKS.indexOf(this.look) + 1) % LOOKS.length]);
  }

  private addFlight(run: Run, index: number, count: number): void {
    const instance = run.system?.view.scene?.instance ?? "";
    // With several runs, each run shows its first body. A single run shows all bodies.
    const infos: Json[] = (run.scene?.bodies ?? []).slice(0, count > 1 ? 1 : undefined);
    for (const [i, info] of infos.entries()) {
      const tone = colour(index + i);
      const body = new Body(run, instance, info, tone, index > 0);
      if (!body.recorded) continue;
      const path = new Path(body.path(), count > 1 || infos.length > 1 ? tone : null);
      body.setChosen(i === 0);
      this.flights.push({ run, name: count > 1 ? run.name : info.name, body, path });
      this.scene.add(body.group, path.group);
      run.onData(() => {
        path.setPoints(body.path());
        if (index + i === 0) this.setColour(this.chosenColour);
      });
    }
  }

  /** True for several bodies of one run, false for the first bodies of several runs. */
  private get hasManyBodies(): boolean {
    return this.flights.length > 1 && this.flights.every(({ run }) => run === this.flights[0].run);
  }

  private get flight(): Flight {
    return this.flights[this.chosen];
  }

  get bodies(): { name: string; position: (time: number) => THREE.Vector3 }[] {
    return this.flights.map(({ name, body }) => ({ name, position: (time) => body.position(time) }));
  }

  get chosenBody(): number {
    return this.chosen;
  }

  /** Makes the cameras follow a body. */
  choose(index: number): void {
    this.chosen = index;
    this.flights.forEach(({ body }, i) => body.setChosen(i === index));
    this.setLook(this.look === "onboard" ? "onboard" : "follow");
    for (const listener of this.choiceListeners) listener();
  }

  onChoice(listener: () => void): void {
    this.choiceListeners.push(listener);
  }

  get drawable(): boolean {
    return this.flights.length > 0;
  }

  private makeTools(): HTMLElement {
    const tools = element("div", { class: "tools" });
    for (const look of LOOKS) {
      const button = element("button", { title: `Camera: ${look} (${LOOKS.indexOf(look) + 1})`, onclick: () => this.setLook(look) }, look);
      this.buttons.set(look, button);
      tools.append(button);
    }
    return tools;
  }

  /** Returns the numbers in the names of more than six bodies, if the names differ only in their numbers, such as
   * drone[3]. Otherwise returns null. */
  private numbersOfNames(): string[] | null {
    const parts = this.flights.map(({ name }) => /^(.*)\[(\d+)\]$/.exec(name));
    const fits = this.flights.length > 6 && parts.every((part) => part !== null && part[1] === parts[0]![1]);
    return fits ? parts.map((part) => part![2]) : null;
  }

  private setColour(index: number): void {
    const chosen = this.colours[index];
    this.chosenColour = index;
    this.legend.replaceChildren();
    if (!chosen || this.flights.length !== 1) {
      const isMany = this.hasManyBodies;
      const numbers = isMany ? this.numbersOfNames() : null;
      if (numbers) this.legend.append("follow:");
      this.legend.append(...this.flights.map(({ name }, i) => {
        const swatch = element("i", { class: "swatch" });
        swatch.style.background = colour(i);
        return isMany ? element("button", { class: "value", title: `Follow ${name}`, onclick: () => this.choose(i) }, swatch, numbers?.[i] ?? name)
          : element("span", { class: "value" }, swatch, name);
      }));
      return;
    }
    const values = chosen.values();
    const sorted = Float64Array.from(values).sort();
    const low = Math.min(0, sorted[0]);
    const high = sorted[Math.floor(0.99 * (sorted.length - 1))]; // otherwise one peak would use the whole range of colours
    this.flights[0].path.colourBy(values, low, high);
    const select = element("select", { "aria-label": "what colours the path" });
    this.colours.forEach((entry, i) => select.append(element("option", { value: String(i) }, entry.label)));
    select.value = String(index);
    select.addEventListener("change", () => this.setColour(Number(select.value)));
    const bar = element("div", { class: "bar" });
    const stops = Array.from({ length: 11 }, (_, i) => `rgb(${scaleColour(i / 10).map((part) => Math.round(255 * part)).join(" ")})`);
    bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    this.legend.append("path flown: ", select, element("span", {}, shown(low, chosen.unit)), bar, element("span", {}, shown(high, chosen.unit)),
      element("i", { class: "swatch ahead" }), "still to fly");
    this.ask();
  }

  private showMoment(): void {
    const time = this.clock.time;
    for (const { run, body, path } of this.flights) {
      body.move(Math.min(time, run.end));
      path.show(rowAt(run.times, time) + 1);
    }
    this.surfaces.move(time);
    const { run, body } = this.flight;
    const place = body.group.position;
    if (this.look === "follow") {
      this.camera.position.add(place).sub(this.followed);
      this.controls.target.copy(place).add(AHEAD);
      this.followed.copy(place);
    }
    this.plumb.geometry.setFromPoints([place, new THREE.Vector3(place.x, place.y, 0)]);
    this.plumb.computeLineDistances();
    const picture = pictureAt(run.pictures, time);
    body.showPicture(picture ? this.texture(picture.url) : null);
    this.ask();
  }

  private texture(url: string): THREE.Texture {
    const known = this.textures.get(url);
    if (known) return known;
    const made = new THREE.TextureLoader().load(url, () => this.ask());
    this.textures.set(url, made);
    return made;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.root;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const { path } of this.flights) path.setResolution(width, height);
    this.ask();
  }

  /** Requests a drawing in the next animation frame. Several calls before this frame cause one drawing. */
  private ask(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }

  private draw(): void {
    if (this.root.clientWidth === 0) return;
    const body = this.flight.body;
    const onboard = this.look === "onboard";
    if (!onboard) this.controls.update();
    const target = this.controls.target;
    this.surfaces.setExposure(onboard ? 1 : EXPOSURE);
    if (onboard) this.surfaces.closeAll();
    else this.surfaces.openTowards(target);
    body.group.visible = !onboard; // its camera does not see it
    if (onboard) this.renderer.setClearColor(this.background);
    else this.renderer.setClearColor(styleColour("--sky"));
    body.eye.aspect = this.camera.aspect;
    body.eye.updateProjectionMatrix();
    this.plumb.visible = !onboard;
    this.renderer.render(this.scene, onboard ? body.eye : this.camera);
    this.placeTags(onboard ? body.eye : this.camera, body, onboard);
    this.tellDrawn();
  }

  private placeTags(camera: THREE.PerspectiveCamera, body: Body, onboard: boolean): void {
    for (const { place, tag } of this.labels) this.put(tag, place, camera);
    const eye = onboard ? null : body.frustumCorner();
    this.eyeTag.hidden = eye === null;
    if (eye) this.put(this.eyeTag, eye, camera);
    // Marks a drone of only a few pixels with a ring.
    const distance = camera.position.distanceTo(body.group.position);
    this.ring.hidden = onboard || distance < 2.6;
    if (!this.ring.hidden) this.put(this.ring, body.group.position, camera);
    this.hideTagsBehindPicture();
  }

  private hideTagsBehindPicture(): void {
    const picture = this.root.querySelector(".picture")?.getBoundingClientRect();
    if (!picture) return;
    const tags = [this.eyeTag, ...this.labels.map((label) => label.tag)];
    const boxes = tags.map((tag) => tag.getBoundingClientRect());
    tags.forEach((tag, i) => {
      const { left, right, top, bottom } = boxes[i];
      if (left < picture.right && right > picture.left && top < picture.bottom && bottom > picture.top) tag.style.display = "none";
    });
  }

  private put(tag: HTMLElement, place: THREE.Vector3, camera: THREE.PerspectiveCamera): void {
    const spot = place.clone().project(camera);
    tag.style.display = spot.z < 1 && Math.abs(spot.x) < 1.05 && Math.abs(spot.y) < 1.05 ? "block" : "none";
    tag.style.left = `${50 + 50 * spot.x}%`;
    tag.style.top = `${50 - 50 * spot.y}%`;
  }
}
