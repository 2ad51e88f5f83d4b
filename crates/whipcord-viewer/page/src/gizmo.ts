// Arrows and planes at the tip that move it along an axis of the world or in a plane, where commands are sought for its place.

import { Group, Object3D, type Camera } from "three";
import { TransformControls } from "three/addons/controls/TransformControls.js";

import type { Vector } from "./protocol";

/** Relative to the usual size. */
const SIZE = 0.55;

export interface Moved {
  grab(): void;
  move(to: Vector): void;
  release(): void;
  /** Something of it looks different. */
  changed(): void;
  /** Whether the view may be turned by the pointer. */
  free(yes: boolean): void;
}

export class Gizmo {
  /** What is drawn. */
  readonly body = new Group();
  readonly #controls: TransformControls;
  readonly #at = new Object3D();

  constructor(camera: Camera, canvas: HTMLElement, moved: Moved) {
    this.#controls = new TransformControls(camera, canvas);
    this.#controls.setSize(SIZE);
    this.body.name = "gizmo";
    this.body.add(this.#controls.getHelper(), this.#at);
    this.#controls.addEventListener("change", () => moved.changed());
    this.#controls.addEventListener("objectChange", () => moved.move(this.#at.position.toArray()));
    this.#controls.addEventListener("dragging-changed", ({ value }: { value: unknown }) => {
      const drags = value === true;
      moved.free(!drags);
      if (drags) moved.grab();
      else moved.release();
    });
  }

  set camera(camera: Camera) {
    this.#controls.camera = camera;
  }

  /** Where the tip is, unless it is being moved; nowhere where it cannot be. */
  set tip(at: Vector | undefined) {
    if (this.#controls.dragging) return;
    if (!at) {
      this.#controls.detach();
      return;
    }
    this.#at.position.set(...at);
    if (this.#controls.object !== this.#at) this.#controls.attach(this.#at);
    this.#at.updateMatrixWorld();
  }
}
