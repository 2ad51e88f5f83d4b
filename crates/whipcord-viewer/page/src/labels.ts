// Words at places in space: names of axes, values of forces, where a cable is slack. Those that would lie on one another are hidden,
// the less important ones first. Pictures write the same words.

import { Vector3, type Camera, type Object3D, type Scene as Space } from "three";
import { CSS2DObject, CSS2DRenderer } from "three/addons/renderers/CSS2DRenderer.js";

import { element } from "./dom";

export interface Label {
  text: string;
  at: readonly [number, number, number];
  /** It is beyond that place as seen from here: at the end of an arrow, not across it. */
  from?: readonly [number, number, number];
  /** Of two on one place the more important one is shown. */
  weight: number;
  colour: string;
}

/** A word on a picture: its middle in pixels of the page. */
export interface Word {
  text: string;
  colour: string;
  x: number;
  y: number;
}

/** Height of a line, and how far the background of a word reaches beyond it at the left and right, in pixels of the page. */
const LINE = 16;
const PADDING = 3;
/** As the style sheet has it. */
const FONT = '600 13px system-ui, "Liberation Sans", "DejaVu Sans", sans-serif';
/** Widths of words are kept as long as there are no more of them. */
const MOST_WIDTHS = 500;

/** From the left and the top to the right and the bottom, in pixels of the page. */
export type Box = readonly [number, number, number, number];

function around(x: number, y: number, wide: number, high: number): Box {
  return [x - wide, y - high, x + wide, y + high];
}

function meet(a: Box, b: Box): boolean {
  return a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1];
}

export class Labels {
  readonly #renderer: CSS2DRenderer;
  readonly #objects: CSS2DObject[] = [];
  #labels: readonly Label[] = [];
  readonly #ruler = element("canvas").getContext("2d");
  readonly #widths = new Map<string, number>();

  constructor(into: HTMLElement) {
    this.#renderer = new CSS2DRenderer();
    const { domElement } = this.#renderer;
    domElement.id = "labels";
    domElement.setAttribute("aria-hidden", "true");
    into.append(domElement);
  }

  resize(width: number, height: number): void {
    this.#renderer.setSize(width, height);
  }

  /** Shows these labels as children of `parent`. */
  show(labels: readonly Label[], parent: Object3D): void {
    this.#labels = labels;
    while (this.#objects.length < labels.length) {
      const object = new CSS2DObject(element("span", { class: "label" }));
      this.#objects.push(object);
      parent.add(object);
    }
    this.#objects.forEach((object, i) => {
      const label = labels[i];
      object.visible = label !== undefined;
      if (!label) return;
      object.position.set(...label.at);
      if (object.element.textContent !== label.text) object.element.textContent = label.text;
      object.element.style.color = label.colour;
    });
  }

  /** `beside` is what words keep off. */
  render(space: Space, camera: Camera, size: { width: number; height: number }, beside: Box): void {
    const seen = new Map(this.words(camera, size, beside).map((word) => [word.label, word]));
    this.#objects.forEach((object, i) => {
      const label = this.#labels[i];
      const word = label && seen.get(label);
      object.visible = word !== undefined;
      // What would stick out of the view is moved into it.
      if (word) object.center.set(0.5 - word.moved[0] / this.#width(word.text), 0.5 - word.moved[1] / LINE);
    });
    this.#renderer.render(space, camera);
  }

  /** Of a word with its background, in pixels of the page. */
  #width(text: string): number {
    const known = this.#widths.get(text);
    if (known !== undefined) return known;
    if (this.#widths.size >= MOST_WIDTHS) this.#widths.clear();
    if (this.#ruler) this.#ruler.font = FONT;
    const width = (this.#ruler?.measureText(text).width ?? 7 * text.length) + 2 * PADDING;
    this.#widths.set(text, width);
    return width;
  }

  /** What of the labels is seen by a camera that makes a picture of so many pixels. */
  words(camera: Camera, { width, height }: { width: number; height: number }, beside?: Box): (Word & { label: Label; moved: [number, number] })[] {
    camera.updateMatrixWorld();
    const taken: Box[] = [];
    const shown: (Word & { label: Label; moved: [number, number] })[] = [];
    const seen = (place: Label["at"]): [number, number, number] => {
      const { x, y, z } = new Vector3(...place).project(camera);
      return [((x + 1) / 2) * width, ((1 - y) / 2) * height, z];
    };
    for (const label of [...this.#labels].sort((a, b) => b.weight - a.weight)) {
      const [x, y, depth] = seen(label.at);
      if (depth < -1 || depth > 1) continue;
      // What it belongs to is not seen.
      const isSeen = ([x, y]: readonly [number, number, number]): boolean => x >= 0 && x <= width && y >= 0 && y <= height;
      if (!isSeen([x, y, depth]) && !(label.from && isSeen(seen(label.from)))) continue;
      const [wide, high] = [this.#width(label.text) / 2, LINE / 2];
      let [left, top] = [x, y];
      if (label.from) {
        const [fromX, fromY] = seen(label.from);
        const [alongX, alongY] = [x - fromX, y - fromY];
        // So far that the place is at its edge.
        const far = Math.min(wide / Math.abs(alongX), high / Math.abs(alongY));
        if (Number.isFinite(far)) [left, top] = [x + far * alongX, y + far * alongY];
      }
      left = Math.min(Math.max(left, wide), Math.max(width - wide, wide));
      top = Math.min(Math.max(top, high), Math.max(height - high, high));
      if (beside && meet(around(left, top, wide, high), beside)) {
        // The shorter way out to the left or downwards: to the right and above it is the edge of the view.
        const [aside, down] = [left + wide - beside[0], beside[3] - (top - high)];
        if (aside < down) left -= aside;
        else top += down;
      }
      const box = around(left, top, wide, high);
      if (taken.some((other) => meet(box, other))) continue;
      taken.push(box);
      shown.push({ text: label.text, colour: label.colour, x: left, y: top, label, moved: [left - x, top - y] });
    }
    return shown;
  }
}
