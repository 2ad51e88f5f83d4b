// The axes in the corner that turn with the view: a press on one looks along it.

import { PerspectiveCamera, Quaternion as Turn, Vector3, type Camera, type WebGLRenderer } from "three";
import { ViewHelper } from "three/addons/helpers/ViewHelper.js";

import type { Cameras } from "./cameras";
import { element } from "./dom";
import type { Box } from "./labels";

/** Width of its square in pixels of the page, and its distance from the corner. */
const SIZE = 128;
const INSET = { top: 36, right: -8 };
/** How far its picture reaches from the middle of the square. */
const REACH = 0.44 * SIZE;

/** What it covers of a view of so many pixels of the page. */
export function covered(width: number): Box {
  const [x, y] = [width - INSET.right - SIZE / 2, INSET.top + SIZE / 2];
  return [x - REACH, y - REACH, x + REACH, y + REACH];
}

export class Compass {
  /** Its camera can be changed, which its types do not say. */
  readonly #helper: ViewHelper & { camera?: Camera };
  readonly #cameras: () => Cameras;
  readonly #canvas: HTMLCanvasElement;
  /** A picture of it over the view, where one is kept, of so many pixels for each of the page, and how the camera was turned for it. */
  readonly #kept: HTMLCanvasElement | undefined;
  #keptRatio = 0;
  readonly #keptTurn = new Turn();
  readonly #turn = new Turn();

  /** `keeps`: as long as the view does not turn its picture stays, as it takes a processor as long to draw as the robot. */
  constructor(canvas: HTMLCanvasElement, keeps: boolean, cameras: () => Cameras, turned: () => void) {
    [this.#canvas, this.#cameras] = [canvas, cameras];
    if (keeps) {
      this.#kept = element("canvas", { "aria-hidden": "true", hidden: true });
      this.#kept.style.cssText = `position: absolute; top: ${INSET.top}px; right: ${INSET.right}px; width: ${SIZE}px; height: ${SIZE}px; pointer-events: none`;
      canvas.after(this.#kept);
    }
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

  /** To be called before the view is drawn: it may need its canvas. Whether the view is to have it on top. */
  prepare(renderer: WebGLRenderer): boolean {
    const kept = this.#kept;
    if (!kept) return true;
    const { quaternion } = this.#cameras().camera;
    const turns = !quaternion.equals(this.#turn);
    this.#turn.copy(quaternion);
    kept.hidden = turns;
    const ratio = renderer.getPixelRatio();
    if (!turns && (ratio > this.#keptRatio || !quaternion.equals(this.#keptTurn))) this.#keep(kept, renderer, ratio);
    return turns;
  }

  #keep(kept: HTMLCanvasElement, renderer: WebGLRenderer, ratio: number): void {
    renderer.setClearColor("#000000", 0);
    renderer.clear();
    this.render(renderer);
    kept.width = kept.height = SIZE * ratio;
    const left = this.#canvas.width - (SIZE + INSET.right) * ratio;
    kept.getContext("2d")?.drawImage(this.#canvas, left, INSET.top * ratio, SIZE * ratio, SIZE * ratio, 0, 0, kept.width, kept.height);
    this.#keptRatio = ratio;
    this.#keptTurn.copy(this.#turn);
  }

  render(renderer: WebGLRenderer): void {
    const { autoClear } = renderer;
    renderer.autoClear = false;
    this.#helper.camera = this.#cameras().camera;
    this.#helper.render(renderer);
    renderer.autoClear = autoClear;
  }
}
