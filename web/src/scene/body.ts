// SPDX-License-Identifier: Apache-2.0
// A flying body: box, arms, rotors, camera with its field of view, and path.
import * as THREE from "three";
import type { Json } from "../data/payload";
import type { Run } from "../data/run";

/** The drawn speed of a rotor at full command [rad/s]. The real speed is too high for the eye. */
const DRAWN_SPEED = 25;
/** The length of the drawn field of view [m]. */
const FRUSTUM_M = 0.3;

export class Body {
  readonly group = new THREE.Group();
  readonly eye = new THREE.PerspectiveCamera();
  private readonly rotors: { disc: THREE.Object3D; sense: number; command: string }[] = [];
  private readonly frustum = new THREE.Group();
  private readonly corner = new THREE.Vector3();
  private readonly screen: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> | null = null;

  /** The names of variables in `info` do not contain the name of the FMU's instance. */
  constructor(readonly run: Run, private readonly instance: string, private readonly info: Json, colour: string, ghost: boolean) {
    const material = (tone: string) =>
      new THREE.MeshBasicMaterial({ color: tone, transparent: ghost, opacity: ghost ? 0.45 : 1 });
    const [length, width, height] = info.size as number[];
    const board = new THREE.Mesh(new THREE.BoxGeometry(0.45 * length, 0.32 * width, 0.5 * height), material(colour));
    const cell = new THREE.Mesh(new THREE.BoxGeometry(0.34 * length, 0.2 * width, 0.3 * height), material("#d8dce2"));
    cell.position.z = 0.38 * height;
    this.group.add(board, cell);
    for (const rotor of info.rotors ?? []) this.addRotor(rotor, material, height);
    if (info.camera) {
      this.addCamera(info.camera, material);
      if (!ghost) this.screen = this.addFrustum(info.camera, colour);
    }
  }

  position(time: number): THREE.Vector3 {
    const [x, y, z] = (this.info.position as string[]).map((name) => this.run.between(this.full(name), time));
    return new THREE.Vector3(x, y, z);
  }

  move(time: number): void {
    this.group.position.copy(this.position(time));
    // Does not interpolate the angles, because yaw jumps from pi to -pi.
    const [roll, pitch, yaw] = (this.info.attitude as string[]).map((name) => this.run.at(this.full(name), time));
    this.group.setRotationFromEuler(new THREE.Euler(roll, pitch, yaw, "ZYX"));
    for (const { disc, sense, command } of this.rotors) {
      disc.rotation.z = sense * DRAWN_SPEED * time * (this.run.at(this.full(command), time) > 0 ? 1 : 0);
    }
    this.group.updateMatrixWorld();
  }

  /** Only the chosen body shows the view of its camera. */
  setChosen(chosen: boolean): void {
    this.frustum.visible = chosen;
  }

  showPicture(texture: THREE.Texture | null): void {
    if (!this.screen) return;
    this.screen.visible = texture !== null;
    if (texture && this.screen.material.map !== texture) {
      this.screen.material.map = texture;
      this.screen.material.needsUpdate = true;
    }
  }

  /** Returns a corner of the drawn field of view in the scene's coordinates. If the body has no camera, returns null. */
  frustumCorner(): THREE.Vector3 | null {
    return this.screen ? this.corner.clone().applyMatrix4(this.eye.matrixWorld) : null;
  }

  get recorded(): boolean {
    return [...(this.info.position as string[]), ...(this.info.attitude as string[])].every((name) => this.run.has(this.full(name)));
  }

  /** Returns the body's recorded positions, three numbers per row of the results. */
  path(): Float32Array {
    const columns = (this.info.position as string[]).map((name) => this.run.values(this.full(name))!);
    const points = new Float32Array(3 * this.run.times.length);
    columns.forEach((values, axis) => values.forEach((value, row) => (points[3 * row + axis] = value)));
    return points;
  }

  private full(name: string): string {
    return `${this.instance}.${name}`;
  }

  private addRotor(rotor: Json, material: (tone: string) => THREE.MeshBasicMaterial, height: number): void {
    const place = new THREE.Vector3(...(rotor.position as [number, number, number]));
    const arm = new THREE.Mesh(new THREE.BoxGeometry(Math.hypot(place.x, place.y), 0.006, 0.004), material("#2b2f36"));
    arm.position.set(place.x / 2, place.y / 2, 0);
    arm.rotation.z = Math.atan2(place.y, place.x);
    const motor = new THREE.Mesh(new THREE.CylinderGeometry(0.0042, 0.0042, 0.7 * height, 12), material("#9aa0a8"));
    motor.rotation.x = Math.PI / 2;
    motor.position.set(place.x, place.y, place.z - 0.35 * height);
    const disc = new THREE.Group();
    const blur = new THREE.Mesh(
      new THREE.CircleGeometry(rotor.radius, 32),
      new THREE.MeshBasicMaterial({ color: "#ffffff", transparent: true, opacity: 0.16, side: THREE.DoubleSide, depthWrite: false }),
    );
    const blade = new THREE.Mesh(new THREE.BoxGeometry(2 * rotor.radius, 0.0045, 0.0012), material("#20242a"));
    disc.add(blur, blade);
    disc.position.copy(place);
    this.rotors.push({ disc, sense: rotor.sense, command: rotor.command });
    this.group.add(arm, motor, disc);
  }

  private addCamera(camera: Json, material: (tone: string) => THREE.MeshBasicMaterial): void {
    const lens = new THREE.Mesh(new THREE.BoxGeometry(0.006, 0.009, 0.009), material("#111418"));
    lens.position.set(...(camera.position as [number, number, number]));
    const height = 2 * Math.atan((Math.tan(camera.field_of_view / 2) * camera.height) / camera.width);
    this.eye.fov = (180 / Math.PI) * height;
    this.eye.aspect = camera.width / camera.height;
    this.eye.near = 0.02;
    this.eye.far = 100;
    this.eye.position.copy(lens.position);
    // A camera of three.js looks along its -z axis, with y up. The drone's camera looks along x, with z up, and is
    // pitched down.
    this.eye.quaternion
      .setFromEuler(new THREE.Euler(0, camera.pitch, 0, "ZYX"))
      .multiply(new THREE.Quaternion().setFromRotationMatrix(
        new THREE.Matrix4().makeBasis(new THREE.Vector3(0, -1, 0), new THREE.Vector3(0, 0, 1), new THREE.Vector3(-1, 0, 0))));
    this.eye.updateProjectionMatrix();
    this.group.add(lens, this.eye);
  }

  /** Draws the field of view as a pyramid, with the camera's picture at its end. */
  private addFrustum(camera: Json, colour: string) {
    const half = FRUSTUM_M * Math.tan(camera.field_of_view / 2);
    const high = (half * camera.height) / camera.width;
    const corners = [[-half, -high], [half, -high], [half, high], [-half, high]].map(([x, y]) => new THREE.Vector3(x, y, -FRUSTUM_M));
    const lines: THREE.Vector3[] = [];
    corners.forEach((corner, i) => lines.push(new THREE.Vector3(), corner, corner, corners[(i + 1) % 4]));
    const edges = new THREE.LineSegments(
      new THREE.BufferGeometry().setFromPoints(lines),
      new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.75 }),
    );
    const screen = new THREE.Mesh(
      new THREE.PlaneGeometry(2 * half, 2 * high),
      new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.45, side: THREE.DoubleSide, depthWrite: false }),
    );
    screen.position.z = -FRUSTUM_M;
    this.corner.copy(corners[2]);
    this.frustum.add(edges, screen);
    this.eye.add(this.frustum);
    return screen;
  }
}
