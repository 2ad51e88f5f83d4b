// From where one looks: in perspective or in parallel, from all sides.

import { Box3, MathUtils, OrthographicCamera, PerspectiveCamera, Vector3 } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";

import type { Eye } from "./eye";
import type { Vector } from "./protocol";

/** The directions that buttons look from. */
export const SIDES = {
  isometric: [1.7, -1.5, 0.8],
  front: [0, -1, 0],
  side: [1, 0, 0],
  top: [0, -1e-4, 1],
} as const satisfies Record<string, Vector>;
export type Side = keyof typeof SIDES;

/** Of the view in perspective, in degrees. */
const ANGLE = 35;
/** How much of the view what is looked at fills, and how far below its middle it is, beside the buttons above: relative to half the view. */
const FILLED = 0.76;
const LOWER = 0.05;

export class Cameras {
  readonly #perspective = new PerspectiveCamera(ANGLE, 1, 1e-3, 100);
  readonly #parallel = new OrthographicCamera(-1, 1, 1, -1, -100, 100);
  readonly #orbit: OrbitControls;
  #isParallel = false;
  #aspect = 1;
  #size: [number, number] = [1, 1];
  #eye: Eye | undefined;

  constructor(orbit: (camera: PerspectiveCamera) => OrbitControls) {
    for (const camera of [this.#perspective, this.#parallel]) camera.up.set(0, 0, 1);
    this.#orbit = orbit(this.#perspective);
  }

  get all(): readonly (PerspectiveCamera | OrthographicCamera)[] {
    return [this.#perspective, this.#parallel];
  }

  /** The calibrated camera that one looks through, if it is one. */
  get eye(): Eye | undefined {
    return this.#eye;
  }

  set eye(eye: Eye | undefined) {
    this.#eye = eye;
    eye?.resize(...this.#size);
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.#eye?.camera ?? this.#own;
  }

  /** Without a calibrated one. */
  get #own(): PerspectiveCamera | OrthographicCamera {
    return this.#isParallel ? this.#parallel : this.#perspective;
  }

  get isParallel(): boolean {
    return this.#isParallel;
  }

  /** The same view in perspective or in parallel: what is looked at keeps its size. */
  set isParallel(yes: boolean) {
    if (yes === this.#isParallel) return;
    const height = this.#height();
    const [from, to] = [this.#own, yes ? this.#parallel : this.#perspective];
    this.#isParallel = yes;
    const { target } = this.#orbit;
    const way = from.position.clone().sub(target).normalize();
    to.position.copy(target).addScaledVector(way, height / (2 * Math.tan(MathUtils.degToRad(ANGLE / 2))));
    this.#parallel.zoom = 2 / height;
    this.#orbit.object = to;
    to.updateProjectionMatrix();
    this.#orbit.update();
  }

  /** Height in m of what is seen at the distance of what is looked at. */
  #height(): number {
    if (this.#isParallel) return 2 / this.#parallel.zoom;
    return 2 * this.#perspective.position.distanceTo(this.#orbit.target) * Math.tan(MathUtils.degToRad(ANGLE / 2));
  }

  /** Pixels for each metre at the distance of what is looked at, of a view of this height. */
  scale(height: number): number {
    return this.#eye?.scaleAt(this.#orbit.target) ?? height / this.#height();
  }

  resize(width: number, height: number): void {
    this.#size = [width, height];
    this.#eye?.resize(width, height);
    this.#aspect = width / height;
    this.#perspective.aspect = this.#aspect;
    [this.#parallel.left, this.#parallel.right] = [-this.#aspect, this.#aspect];
    for (const camera of this.all) camera.updateProjectionMatrix();
  }

  /** Distances that are drawn, for a robot of this length. */
  reach(length: number): void {
    [this.#perspective.near, this.#perspective.far] = [0.01 * length, 50 * length];
    [this.#parallel.near, this.#parallel.far] = [-50 * length, 50 * length];
    for (const camera of this.all) camera.updateProjectionMatrix();
  }

  /** Looks at all of these points from a side; without one, from where one looks now. */
  fit(points: readonly Vector[], length: number, direction: Vector | undefined): void {
    const box = new Box3().setFromPoints(points.map((point) => new Vector3(...point)));
    const middle = box.getCenter(new Vector3());
    const way = direction ? new Vector3(...direction) : this.#own.position.clone().sub(this.#orbit.target);
    way.normalize();
    // What the points take up across and along the picture.
    const camera = this.#own;
    camera.position.copy(middle).add(way);
    camera.lookAt(middle);
    const [right, up] = [new Vector3(), new Vector3()];
    camera.matrix.extractBasis(right, up, new Vector3());
    camera.updateMatrix();
    camera.matrix.extractBasis(right, up, new Vector3());
    const extent = (along: Vector3): number => Math.max(...points.map((point) => Math.abs(new Vector3(...point).sub(middle).dot(along))));
    const depth = Math.max(...points.map((point) => new Vector3(...point).sub(middle).dot(way)), 0);
    const half = Math.max(extent(up), extent(right) / this.#aspect, 0.15 * length) / FILLED;
    const distance = half / Math.tan(MathUtils.degToRad(ANGLE / 2)) + (this.#isParallel ? 0 : depth);
    middle.addScaledVector(up, LOWER * half);
    this.#orbit.target.copy(middle);
    camera.position.copy(middle).addScaledVector(way, distance);
    this.#parallel.zoom = 1 / half;
    camera.updateProjectionMatrix();
    this.#orbit.update();
  }

  /** Looks from a direction, as far away as now. */
  turn(direction: Vector3): void {
    const { target } = this.#orbit;
    const distance = this.#own.position.distanceTo(target);
    const way = direction.clone().normalize();
    // Straight from above or below there is no up: what lies in front then is below.
    if (Math.hypot(way.x, way.y) < 1e-3) way.y -= 1e-4;
    this.#own.position.copy(target).addScaledVector(way, distance);
    this.#orbit.update();
  }

  zoom(factor: number): void {
    const { target } = this.#orbit;
    if (this.#isParallel) this.#parallel.zoom *= factor;
    else this.#perspective.position.sub(target).multiplyScalar(1 / factor).add(target);
    this.#own.updateProjectionMatrix();
    this.#orbit.update();
  }

  /** From where, and at what one looks, in m; in parallel also the height in m that is seen. */
  get view(): number[] {
    const six = [...this.#own.position.toArray(), ...this.#orbit.target.toArray()];
    return this.#isParallel ? [...six, this.#height()] : six;
  }

  set view(view: readonly number[]) {
    const height = view[6];
    this.isParallel = height !== undefined;
    this.#own.position.fromArray(view as number[], 0);
    this.#orbit.target.fromArray(view as number[], 3);
    if (height !== undefined) this.#parallel.zoom = 2 / height;
    this.#own.updateProjectionMatrix();
    this.#orbit.update();
  }
}
