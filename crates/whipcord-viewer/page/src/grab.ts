// Taking hold of the robot: of its tip, or of any place of its backbone, which are then moved in the plane of the view.

import { Plane, Raycaster, Vector2, Vector3, type Camera } from "three";

import type { Vector } from "./protocol";

export interface Grabbing {
  /** Places of the backbone that can be taken hold of, in the world, the tip last. */
  places(): readonly Vector[];
  /** Whether only the tip can be. */
  onlyTip(): boolean;
  /** The place with this number is taken hold of. */
  grab(station: number): void;
  /** The pointer is here now, in the plane of the view through the place. */
  move(to: Vector): void;
  release(): void;
  /** The place that a press would take hold of, if there is one. */
  hover(station: number | undefined): void;
}

/** How near to the tip, and to the rest of the backbone, a press takes hold, in pixels of the page. */
const NEAR_TIP = 16;
const NEAR = 10;

export class Grab {
  readonly #canvas: HTMLCanvasElement;
  readonly #camera: () => Camera;
  readonly #grabbing: Grabbing;
  readonly #caster = new Raycaster();
  readonly #plane = new Plane();
  #held: number | undefined;

  /** `free` lets the view be turned by the pointer, or not. */
  constructor(canvas: HTMLCanvasElement, camera: () => Camera, grabbing: Grabbing, free: (yes: boolean) => void) {
    [this.#canvas, this.#camera, this.#grabbing] = [canvas, camera, grabbing];
    canvas.addEventListener("pointerdown", (event) => {
      const station = this.#held === undefined && event.button === 0 ? this.#near(event) : undefined;
      if (station === undefined) return;
      this.#held = event.pointerId;
      free(false);
      canvas.setPointerCapture(event.pointerId);
      const at = new Vector3(...grabbing.places()[station]!);
      this.#plane.setFromNormalAndCoplanarPoint(camera().getWorldDirection(new Vector3()), at);
      grabbing.grab(station);
      event.stopImmediatePropagation();
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (this.#held !== undefined) {
        if (this.#held === event.pointerId) this.#move(event);
        return;
      }
      const station = event.buttons === 0 ? this.#near(event) : undefined;
      canvas.style.cursor = station === undefined ? "" : "grab";
      grabbing.hover(station);
    });
    canvas.addEventListener("pointerleave", () => {
      if (this.#held === undefined) grabbing.hover(undefined);
    });
    const release = (event: PointerEvent): void => {
      if (this.#held !== event.pointerId) return;
      this.#held = undefined;
      free(true);
      canvas.style.cursor = "";
      grabbing.release();
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
  }

  #move(event: PointerEvent): void {
    const box = this.#canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.#caster.setFromCamera(new Vector2(x, y), this.#camera());
    this.#canvas.style.cursor = "grabbing";
    const to = this.#caster.ray.intersectPlane(this.#plane, new Vector3());
    if (to) this.#grabbing.move([to.x, to.y, to.z]);
  }

  /** The place that is seen nearest to the pointer. */
  #near(event: PointerEvent): number | undefined {
    const box = this.#canvas.getBoundingClientRect();
    const places = this.#grabbing.places();
    const last = places.length - 1;
    const camera = this.#camera();
    const distance = (place: Vector): number => {
      const { x, y, z } = new Vector3(...place).project(camera);
      if (z > 1) return Infinity;
      return Math.hypot(box.left + ((x + 1) / 2) * box.width - event.clientX, box.top + ((1 - y) / 2) * box.height - event.clientY);
    };
    if (last < 0) return undefined;
    if (distance(places[last]!) < NEAR_TIP) return last;
    if (this.#grabbing.onlyTip()) return undefined;
    // The base does not move.
    let nearest: number | undefined;
    let least = NEAR;
    for (let i = 1; i < last; i++) {
      const d = distance(places[i]!);
      if (d < least) [nearest, least] = [i, d];
    }
    return nearest;
  }
}
