// A slider with its number box. Where it has both signs its middle is zero; a mark says how far there was a solution.

import { element } from "./dom";
import type { State } from "./state";
import { fromUnit, significant, toUnit, type Unit } from "./units";

export interface Changes {
  /** While a slider moves. */
  change(edit: (state: State) => void): void;
  /** When it has been let go: what undo comes back to. */
  commit(): void;
}

/** Steps of a slider from end to end. */
const STEPS = 1000;

export class Slider {
  readonly row: HTMLElement;
  readonly #slider: HTMLInputElement;
  readonly #box: HTMLInputElement;
  readonly #zero = element("span", { class: "zero", "aria-hidden": "true" });
  readonly #mark = element("span", { class: "mark", hidden: true });
  readonly #badge = element("span", { class: "badge", hidden: true });
  readonly #symbol: HTMLElement;
  #unit: Unit;
  #bound: readonly [number, number] = [-Infinity, Infinity];
  /** What is shown. */
  #value = NaN;
  #solvable: number | undefined;

  constructor(
    label: string,
    name: string,
    what: string,
    unit: Unit,
    range: readonly [number, number],
    changes: Changes,
    edit: (state: State, value: number) => void,
    symbol: HTMLElement = element("span", { class: "unit" }),
  ) {
    this.#unit = unit;
    this.#symbol = symbol;
    const id = `q-${name}`;
    this.#slider = element("input", { type: "range", id, "data-name": name });
    this.#box = element("input", { type: "number", "data-name": name });
    this.row = element(
      "div",
      { class: "quantity", title: what },
      element("span", { class: "name" }, element("label", { for: id }, label), this.#badge),
      this.#box,
      symbol,
      element("div", { class: "track" }, this.#zero, this.#slider, this.#mark),
    );
    this.#slider.addEventListener("input", () => {
      const value = Number(this.#slider.value);
      changes.change((state) => edit(state, value));
    });
    this.#slider.addEventListener("change", () => changes.commit());
    this.#box.addEventListener("change", () => {
      const value = Number(this.#box.value);
      if (this.#box.value.trim() === "" || !Number.isFinite(value)) return this.#write(this.#value);
      const [least, most] = this.#bound;
      const given = Math.min(Math.max(fromUnit(value, this.#unit), least), most);
      changes.change((state) => edit(state, given));
      changes.commit();
      this.#write(this.#value);
    });
    this.range(range, unit, label);
  }

  range([least, most]: readonly [number, number], unit: Unit, label: string): void {
    this.#value = NaN;
    this.#unit = unit;
    this.#ends(least, most);
    this.#slider.step = String((most - least) / STEPS);
    // An arrow key in the box steps by a round part of the range.
    this.#box.step = String(10 ** Math.floor(Math.log10((most - least) / unit.si / 100)));
    this.#box.setAttribute("aria-label", `${label} in ${unit.word}`);
    this.#symbol.textContent = unit.symbol;
  }

  #ends(least: number, most: number): void {
    this.#slider.min = String(least);
    this.#slider.max = String(most);
    this.#zero.hidden = !(least < 0 && most > 0);
    this.#zero.style.left = share((0 - least) / (most - least));
    this.#place();
  }

  /** Holds the slider between these ends. */
  bound(least: number, most: number): void {
    this.#value = NaN;
    this.#bound = [least, most];
    this.#ends(least, most);
    this.#slider.step = String(Math.max((most - least) / STEPS, Number.MIN_VALUE));
    const still = least === most;
    for (const input of [this.#slider, this.#box]) input.disabled = still;
    this.#symbol.toggleAttribute("disabled", true);
  }

  /** `anew`: over what is being typed, too. */
  show(value: number, anew = false): void {
    if (value === this.#value && !anew) return;
    // A number typed beyond the slider's end moves the end, and the other one where zero is in the middle.
    const [least, most] = [Number(this.#slider.min), Number(this.#slider.max)];
    if (value > most) this.#ends(least < 0 && least === -most ? -value : least, value);
    else if (value < least) this.#ends(value, most === -least ? -value : most);
    this.#value = value;
    // What is the same is not set: each time that makes the browser look at all boxes of the page.
    if (Number(this.#slider.value) !== value) this.#slider.value = String(value);
    this.#fill();
    const shown = toUnit(value, this.#unit);
    this.#slider.setAttribute("aria-valuetext", `${Number(shown.toPrecision(4))} ${this.#unit.word}`);
    if (anew || document.activeElement !== this.#box || Number(this.#box.value) !== shown) this.#write(value);
  }

  /** The coloured part goes from zero to the value. */
  #fill(): void {
    const [least, most] = [Number(this.#slider.min), Number(this.#slider.max)];
    const at = (of: number): number => Math.min(Math.max((of - least) / (most - least || 1), 0), 1);
    const ends = [at(0), at(this.#value)].sort((a, b) => a - b);
    this.#slider.style.setProperty("--from", share(ends[0]!));
    this.#slider.style.setProperty("--to", share(ends[1]!));
  }

  /** Marks the last value that had a solution, or none. */
  solvable(value: number | undefined): void {
    if (value === this.#solvable) return;
    this.#solvable = value;
    this.#place();
  }

  /** A word beside the name. */
  badge(word: string | undefined): void {
    this.#badge.hidden = word === undefined;
    if (word !== undefined && this.#badge.textContent !== word) this.#badge.textContent = word;
  }

  #place(): void {
    const value = this.#solvable;
    this.#mark.hidden = value === undefined;
    if (value === undefined) return;
    const [least, most] = [Number(this.#slider.min), Number(this.#slider.max)];
    const at = Math.min(Math.max((value - least) / (most - least), 0), 1);
    this.#mark.style.left = share(at);
    this.#mark.dataset["side"] = at > 0.6 ? "left" : "right";
    this.#mark.textContent = `last solution at ${significant(toUnit(value, this.#unit), 4)} ${this.#unit.symbol}`;
  }

  #write(value: number): void {
    const shown = toUnit(value, this.#unit);
    const whole = String(Number(shown.toPrecision(6)));
    // With an exponent it would not be seen whole.
    const words = whole.includes("e") ? String(Number(shown.toPrecision(3))) : whole;
    if (this.#box.value !== words) this.#box.value = words;
  }
}

/** A place along the slider, whose ends are half a thumb from those of its track. */
function share(at: number): string {
  return `calc(8px + (100% - 16px) * ${at.toFixed(4)})`;
}
