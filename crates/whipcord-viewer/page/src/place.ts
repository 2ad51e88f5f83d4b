// Boxes for the place of the tip, in the world: what the pointer does at its handle, by the keyboard.

import { element } from "./dom";
import type { Vector } from "./protocol";
import { fromUnit, MILLIMETRE, toUnit } from "./units";

const AXES = ["x", "y", "z"] as const;

export class PlaceBoxes {
  readonly row: HTMLElement;
  readonly #boxes: HTMLInputElement[];
  #place: Vector | undefined;
  /** Digits behind the point. */
  readonly #digits: number;

  /** `length` is that of the robot in m; `move` is to bring the tip to a place. */
  constructor(length: number, move: (to: Vector) => void) {
    // An arrow key steps by a round part of the length.
    const order = Math.floor(Math.log10(toUnit(length, MILLIMETRE) / 50));
    this.#digits = Math.min(Math.max(2 - order, 0), 9);
    const step = 10 ** order;
    this.#boxes = AXES.map((axis) => element("input", { type: "number", "data-name": `tip-${axis}`, step, "aria-label": `Place of the tip along ${axis} in millimetres` }));
    this.#boxes.forEach((box, k) =>
      box.addEventListener("change", () => {
        const value = Number(box.value);
        const place = this.#place;
        if (!place || box.value.trim() === "" || !Number.isFinite(value)) return this.#write();
        const to: Vector = [...place];
        to[k] = fromUnit(value, MILLIMETRE);
        move(to);
      }),
    );
    this.row = element(
      "div",
      { class: "place", title: "Where the tip is, in the world; another number brings it there, within the limits" },
      ...AXES.map((axis, k) => element("label", {}, axis, this.#boxes[k]!)),
      element("span", { class: "unit" }, MILLIMETRE.symbol),
    );
  }

  /** Where the tip is; without a place there is nothing to be moved. */
  show(place: Vector | undefined): void {
    this.row.hidden = place === undefined;
    this.#place = place;
    this.#write();
  }

  #write(): void {
    this.#boxes.forEach((box, k) => {
      // Adding zero takes the sign of a zero away.
      const text = this.#place ? String(Number(toUnit(this.#place[k]!, MILLIMETRE).toFixed(this.#digits)) + 0) : "";
      if (box.value !== text) box.value = text;
    });
  }
}
