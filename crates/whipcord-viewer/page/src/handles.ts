// What the robot is moved by: the ring at its tip, what a press would take hold of, the spring to the pointer, and the place that the
// tip is to go to. All are seen through bodies, and none is on pictures.

import { CanvasTexture, Group, Sprite, SpriteMaterial, Vector3 } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

import { HANDLE } from "./colours";
import type { Vector } from "./protocol";

/** Width of a ring in pixels of the page, and of its picture. */
const RING = 26;
const SMALL = 18;
const PIXELS = 64;

/** `thick` is relative to the radius; all of it is a disc. */
function ring(thick: number): Sprite {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [PIXELS, PIXELS];
  const context = canvas.getContext("2d");
  if (context) {
    const radius = PIXELS / 2 - 6;
    for (const [colour, more] of [["#ffffff", 6], [HANDLE, 0]] as const) {
      context.lineWidth = thick * radius + more;
      context.strokeStyle = colour;
      context.beginPath();
      context.arc(PIXELS / 2, PIXELS / 2, radius * (1 - thick / 2), 0, 2 * Math.PI);
      context.stroke();
    }
  }
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, depthWrite: false, toneMapped: false }));
  sprite.renderOrder = 8;
  sprite.visible = false;
  return sprite;
}

export class Handles {
  readonly group = new Group();
  readonly #tip = ring(0.3);
  readonly #hover = ring(0.3);
  readonly #hand = ring(1);
  readonly #target = ring(1);
  readonly #mark = ring(0.45);
  readonly #material = new LineMaterial({ color: HANDLE, linewidth: 3, depthTest: false, transparent: true, dashed: false });
  readonly #line = new Line2(new LineGeometry(), this.#material);

  constructor() {
    this.#line.renderOrder = 7;
    this.#line.visible = false;
    this.#line.frustumCulled = false;
    this.group.add(this.#line, this.#tip, this.#hover, this.#hand, this.#target, this.#mark);
  }

  tip(at: Vector | undefined): void {
    put(this.#tip, at);
  }

  /** What a press would take hold of. */
  hover(at: Vector | undefined): void {
    put(this.#hover, at);
  }

  /** A place of the backbone that a chart points at. */
  mark(at: Vector | undefined): void {
    put(this.#mark, at);
  }

  /** Where the tip is to go. */
  target(at: Vector | undefined): void {
    put(this.#target, at);
  }

  /** The spring from a place to the pointer. */
  spring(ends: readonly [Vector, Vector] | undefined): void {
    put(this.#hand, ends?.[1]);
    this.#line.visible = ends !== undefined;
    if (!ends) return;
    // Positions that are set anew would leave the buffers of those before.
    this.#line.geometry.dispose();
    this.#line.geometry = new LineGeometry().setPositions(ends.flat());
  }

  /** Sizes of the rings: so many pixels of the page, whatever the distance. */
  size(scale: (at: Vector3) => number, width: number, height: number): void {
    this.#material.resolution.set(width, height);
    for (const sprite of [this.#tip, this.#hover, this.#hand, this.#target, this.#mark]) {
      if (!sprite.visible) continue;
      sprite.scale.setScalar((sprite === this.#tip || sprite === this.#hover ? RING : SMALL) / scale(sprite.position));
    }
  }

  /** Where the tip's ring, the end of the spring at the pointer and its other end are. */
  get places(): { tip: Vector3 | undefined; hand: Vector3 | undefined } {
    return { tip: this.#tip.visible ? this.#tip.position : undefined, hand: this.#hand.visible ? this.#hand.position : undefined };
  }
}

function put(sprite: Sprite, at: Vector | undefined): void {
  sprite.visible = at !== undefined;
  if (at) sprite.position.set(...at);
}
