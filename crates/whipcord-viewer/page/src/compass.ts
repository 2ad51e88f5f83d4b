// The axes in the corner that turn with the view: a press on one looks along it.

import { PerspectiveCamera, Vector3, type Camera, type WebGLRenderer } from "three";
import { ViewHelper } from "three/addons/helpers/ViewHelper.js";

import type { Cameras } from "./cameras";

/** Width of its square in pixels of the page, and its distance from the corner. */
const SIZE = 128;
const INSET = { top: 36, right: -8 };

export class Compass {
  /** Its camera can be changed, which its types do not say. */
  readonly #helper: ViewHelper & { camera?: Camera };
  readonly #cameras: () => Cameras;

  constructor(canvas: HTMLCanvasElement, cameras: () => Cameras, turned: () => void) {
    this.#cameras = cameras;
    this.#helper = new ViewHelper(cameras().camera, canvas);
    this.#helper.location = { top: INSET.top, right: INSET.right, bottom: 0, left: null };
    this.#helper.setLabelStyle("bold 26px system-ui, sans-serif", "#000000", 15);
    this.#helper.setLabels("x", "y", "z");
    canvas.addEventListener("pointerdown", (event) => {
      const box = canvas.getBoundingClientRect();
      const [right, top] = [box.right - event.clientX - INSET.right, event.clientY - box.top - INSET.top];
      if (right < 0 || right > SIZE || top < 0 || top > SIZE) return;
      const way = this.#pressed(event);
      if (!way) return;
      event.stopImmediatePropagation();
      cameras().turn(way);
      turned();
    }, { capture: true });
  }

  /** The axis that was pressed. The helper would turn the view about y, which is up for it: only where it would end counts here. */
  #pressed(event: PointerEvent): Vector3 | undefined {
    const probe = new PerspectiveCamera();
    probe.position.set(0, 0, 1);
    const own = this.#cameras().camera;
    this.#helper.quaternion.copy(own.quaternion).invert();
    this.#helper.updateMatrixWorld();
    this.#helper.camera = probe;
    const hit = this.#helper.handleClick(event);
    if (hit) for (let k = 0; k < 10 && this.#helper.animating; k++) this.#helper.update(1);
    this.#helper.camera = own;
    return hit ? probe.position.clone().normalize() : undefined;
  }

  render(renderer: WebGLRenderer): void {
    const { autoClear } = renderer;
    renderer.autoClear = false;
    this.#helper.camera = this.#cameras().camera;
    this.#helper.render(renderer);
    renderer.autoClear = autoClear;
  }
}
