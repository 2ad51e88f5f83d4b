// Sliders and number boxes.

import { element } from "./dom";
import { swatch } from "./legend";
import type { MetLimit, Motor, Reach, Scene, Vector } from "./protocol";
import { COLOURINGS, commandOf, DRAGGING, valueOf, type Colouring, type Dragging, type Kind, type State } from "./state";
import {
  DEGREE,
  fromUnit,
  METRE_PER_SECOND_SQUARED,
  MILLIMETRE,
  MILLINEWTON_METRE,
  NEWTON,
  significant,
  toUnit,
  type Unit,
} from "./units";

export interface Changes {
  /** While a slider moves. */
  change(edit: (state: State) => void): void;
  /** When it has been let go: what undo comes back to. */
  commit(): void;
  /** Acts once the shape that is shown is the answer to what the sliders say, on what became of a cable in it, if that is known. */
  whenShown(cable: number, act: (present: { tension: number | null; shortening: number } | undefined) => void): void;
}

/** Steps of a slider from end to end. */
const STEPS = 1000;

/** A slider with its number box. */
class Quantity {
  readonly row: HTMLElement;
  readonly #slider: HTMLInputElement;
  readonly #box: HTMLInputElement;
  #unit: Unit;
  #bound: readonly [number, number] = [-Infinity, Infinity];
  /** What is shown. */
  #value = NaN;
  readonly #symbol: HTMLElement;

  constructor(
    label: string,
    name: string,
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
    this.row = element("div", { class: "quantity" }, element("label", { for: id, title: label }, label), this.#slider, this.#box, symbol);
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
    this.#slider.min = String(least);
    this.#slider.max = String(most);
    this.#slider.step = String((most - least) / STEPS);
    // An arrow key in the box steps by a round part of the range.
    this.#box.step = String(10 ** Math.floor(Math.log10((most - least) / unit.si / 100)));
    this.#box.setAttribute("aria-label", `${label} in ${unit.word}`);
    this.#symbol.textContent = unit.symbol;
  }

  /** Holds the slider between these ends. */
  bound(least: number, most: number): void {
    this.#value = NaN;
    this.#bound = [least, most];
    this.#slider.min = String(least);
    this.#slider.max = String(most);
    this.#slider.step = String(Math.max((most - least) / STEPS, Number.MIN_VALUE));
    const still = least === most;
    for (const input of [this.#slider, this.#box]) input.disabled = still;
    this.#symbol.toggleAttribute("disabled", true);
  }

  /** `anew`: over what is being typed, too. */
  show(value: number, anew = false): void {
    if (value === this.#value && !anew) return;
    // A number typed beyond the slider's end moves the end.
    if (value > Number(this.#slider.max)) this.#slider.max = String(value);
    if (value < Number(this.#slider.min)) this.#slider.min = String(value);
    this.#value = value;
    this.#slider.value = String(value);
    const shown = toUnit(value, this.#unit);
    this.#slider.setAttribute("aria-valuetext", `${Number(shown.toPrecision(4))} ${this.#unit.word}`);
    if (anew || document.activeElement !== this.#box || Number(this.#box.value) !== shown) this.#write(value);
  }

  #write(value: number): void {
    this.#box.value = String(Number(toUnit(value, this.#unit).toPrecision(6)));
  }
}

export class Controls {
  readonly #sliders: Quantity[];
  readonly #kinds: Kind[];
  readonly #vectors: { of: (state: State) => Vector; each: Quantity[] }[];
  readonly #models = new Map<string, HTMLInputElement>();
  readonly #colouring: HTMLSelectElement;
  readonly #compliance: HTMLInputElement;
  readonly #workspace: HTMLInputElement;
  readonly #dragging = new Map<Dragging, HTMLInputElement>();
  readonly #limits = element("p", { class: "hint", id: "limits", role: "status", hidden: true });
  readonly #scene: Scene;
  readonly #axes: readonly number[][] | undefined;

  /** `axes` are the positions of the sliders of cables and motors in an exported page, in which nothing else can be moved, and `hasCloud`
   * says whether it knows where the tip can go. */
  constructor(
    scene: Scene,
    into: HTMLElement,
    changes: Changes,
    colourOf: (model: string) => string,
    axes?: readonly number[][],
    hasCloud = axes === undefined,
  ) {
    this.#scene = scene;
    this.#axes = axes;
    const { ranges } = scene;
    this.#kinds = scene.sliders.map((slider) => ("motor" in slider ? "motor" : "tension"));
    this.#sliders = scene.sliders.map((slider, i) =>
      "motor" in slider ? this.#motor(scene.motors[slider.motor]!, slider.motor, i, changes) : this.#cable(slider.cable, i, changes),
    );
    const directions = ["x", "y", "z"] as const;
    const vector = (name: string, unit: Unit, reach: number, of: (state: State) => Vector): Quantity[] =>
      directions.map((axis, k) =>
        new Quantity(axis, `${name}-${axis}`, unit, [-reach, reach], changes, (state, value) => {
          of(state)[k] = value;
        }),
      );
    this.#vectors = [
      { of: (state) => state.tipForce, each: vector("force", NEWTON, ranges.force, (state) => state.tipForce) },
      { of: (state) => state.tipMoment, each: vector("moment", MILLINEWTON_METRE, ranges.moment, (state) => state.tipMoment) },
      { of: (state) => state.gravity, each: vector("gravity", METRE_PER_SECOND_SQUARED, ranges.gravity, (state) => state.gravity) },
    ];
    this.#colouring = element("select", { id: "colouring" }, ...COLOURINGS.map((name) => element("option", { value: name }, name)));
    this.#colouring.addEventListener("change", () => {
      changes.change((state) => void (state.colouring = this.#colouring.value as Colouring));
      changes.commit();
    });
    this.#compliance = element("input", { type: "checkbox", id: "compliance" });
    this.#compliance.addEventListener("change", () => {
      changes.change((state) => void (state.compliance = this.#compliance.checked));
      changes.commit();
    });
    this.#workspace = element("input", { type: "checkbox", id: "workspace" });
    this.#workspace.addEventListener("change", () => {
      changes.change((state) => void (state.workspace = this.#workspace.checked));
      changes.commit();
    });
    const fixed = scene.loads_in_base ? "in the frame of the base" : "in the world";
    const frame = scene.tip_follower ? "in the frame of the tip, with which it turns, as the moment does" : fixed;
    const force = group("Force at the tip", ...this.#vectors[0]!.each.map((q) => q.row));
    force.append(element("p", { class: "hint" }, `Drag the tip, or set it here, ${frame}.`));
    const drag = group("Dragging the tip", ...DRAGGING.map((name) => this.#drag(name, changes)), this.#limits);
    const loads = [
      force,
      group("Moment at the tip", ...this.#vectors[1]!.each.map((q) => q.row)),
      group("Gravity", ...this.#vectors[2]!.each.map((q) => q.row)),
    ];
    into.replaceChildren(
      ...(scene.motors.length > 0 ? [group("Motors", ...this.#rows("motor"))] : []),
      ...(scene.motors.length === 0 || this.#rows("cable").length > 0 ? [group("Cables", ...this.#rows("cable"))] : []),
      ...(axes ? [] : [drag, ...loads]),
      group("Models", ...scene.models.filter((model) => !axes || model.refusal === null).map((model) => this.#model(model.name, model.refusal, changes, colourOf(model.name)))),
      group(
        "Show",
        element("div", { class: "choice" }, element("label", { for: "colouring" }, "Colour by"), this.#colouring),
        ...(axes ? [] : [
          element("div", { class: "choice" }, this.#compliance, element("label", { for: "compliance" }, "Compliance of the tip")),
        ]),
        ...(hasCloud ? [
          element("div", { class: "choice" }, this.#workspace, element("label", { for: "workspace" }, "Where the tip can go")),
          element("p", { class: "hint", id: "cloud", role: "status", hidden: true }),
        ] : []),
      ),
    );
    axes?.forEach((values, i) => this.#sliders[i]!.bound(values[0]!, values.at(-1)!));
    if (scene.other_loads.length > 0) {
      into.append(element("p", { class: "hint" }, `The file also has: ${scene.other_loads.join("; ")}.`));
    }
    const told = scene.warnings;
    if (told.length > 0) {
      const count = told.length === 1 ? "1 warning" : `${told.length} warnings`;
      const each = told.map(({ message, help }) => element("li", {}, `${message}. To do: ${help}.`));
      into.append(element("details", { class: "warnings" }, element("summary", {}, `${count} about the file`), element("ul", {}, ...each)));
    }
  }

  /** `anew`: over what is being typed in a box, too. */
  show(state: State, anew: boolean): void {
    state.commands.forEach((command, i) => {
      const { kind, value } = valueOf(command);
      const { ranges, cables, sliders } = this.#scene;
      const slider = sliders[i]!;
      if (kind !== this.#kinds[i] && "cable" in slider) {
        this.#kinds[i] = kind;
        const range: [number, number] = kind === "tension" ? [0, ranges.tension] : [-ranges.shortening, ranges.shortening];
        this.#sliders[i]!.range(range, kind === "tension" ? NEWTON : MILLIMETRE, cables[slider.cable]!.name);
        const axis = this.#axes?.[i];
        if (axis) this.#sliders[i]!.bound(axis[0]!, axis.at(-1)!);
      }
      this.#sliders[i]!.show(value, anew);
    });
    for (const { of, each } of this.#vectors) each.forEach((quantity, k) => quantity.show(of(state)[k]!, anew));
    for (const [name, box] of this.#models) box.checked = state.models.includes(name);
    this.#colouring.value = state.colouring;
    this.#compliance.checked = state.compliance;
    this.#workspace.checked = state.workspace;
    for (const [name, button] of this.#dragging) button.checked = state.dragging === name;
  }

  /** Marks the sliders at a limit, and says which limits the robot is at, or why it does not get to the pointer. */
  limits(reach: Reach | null): void {
    const met = reach?.status === "found" ? reach.limits : [];
    this.#sliders.forEach(({ row }, i) => row.classList.toggle("limited", met.some(({ slider }) => slider === i)));
    const words =
      reach?.status === "failed" ? reach.message
      : reach && !reach.reached ? `${significant(1e3 * reach.distance, 3)} mm from the pointer${met.length > 0 ? `, at a limit: ${list(met)}` : ""}`
      : met.length > 0 ? `At a limit: ${list(met)}`
      : "";
    if (this.#limits.textContent !== words) this.#limits.textContent = words;
    this.#limits.hidden = words === "";
  }

  /** The sliders of cables, or those of motors. */
  #rows(of: "cable" | "motor"): HTMLElement[] {
    return this.#sliders.filter((_, i) => of in this.#scene.sliders[i]!).map((q) => q.row);
  }

  #motor({ name, is_angular, reach }: Motor, number: number, i: number, changes: Changes): Quantity {
    const edit = (state: State, value: number): void => void (state.commands[i] = { motor: value });
    return new Quantity(name, `motor-${number}`, is_angular ? DEGREE : MILLIMETRE, reach, changes, edit);
  }

  #cable(cable: number, i: number, changes: Changes): Quantity {
    const { name } = this.#scene.cables[cable]!;
    const toggle = element("button", {
      type: "button",
      class: "unit",
      title: "Pull by tension or by length",
      "aria-label": `Cable ${name}: change between tension and shortening`,
      "data-cable": cable,
      onclick: () => changes.whenShown(cable, (present) => {
        changes.change((state) => {
          const { kind } = valueOf(state.commands[i]!);
          // The robot stays as it is, as far as its shape says what takes the place of what was given.
          const value = kind === "tension" ? present?.shortening : present?.tension;
          const other = kind === "tension" ? "shortening" : "tension";
          state.commands[i] = commandOf(other, Number((value ?? 0).toPrecision(6)));
        });
        changes.commit();
      }),
    });
    const edit = (state: State, value: number): void => {
      const { kind } = valueOf(state.commands[i]!);
      state.commands[i] = commandOf(kind, kind === "tension" ? Math.max(value, 0) : value);
    };
    return new Quantity(name, `cable-${cable}`, NEWTON, [0, this.#scene.ranges.tension], changes, edit, toggle);
  }

  #drag(name: Dragging, changes: Changes): HTMLElement {
    const id = `drag-${name}`;
    const button = element("input", { type: "radio", name: "dragging", id, value: name });
    button.addEventListener("change", () => {
      changes.change((state) => void (state.dragging = name));
      changes.commit();
    });
    this.#dragging.set(name, button);
    const words = name === "force" ? "A force pulls at it" : "It follows the pointer";
    return element("div", { class: "choice" }, button, element("label", { for: id }, words));
  }

  #model(name: string, refusal: string | null, changes: Changes, colour: string): HTMLElement {
    const id = `model-${name}`;
    const box = element("input", { type: "checkbox", id, disabled: refusal !== null });
    box.addEventListener("change", () => {
      changes.change((state) => {
        const others = state.models.filter((other) => other !== name);
        const order = this.#scene.models.map((model) => model.name);
        state.models = box.checked ? [...others, name].sort((a, b) => order.indexOf(a) - order.indexOf(b)) : others;
      });
      changes.commit();
    });
    this.#models.set(name, box);
    const row = element("div", { class: "choice" }, box, swatch(colour), element("label", { for: id }, name));
    if (refusal !== null) {
      const why = `why-${name}`;
      box.setAttribute("aria-describedby", why);
      row.append(element("p", { class: "hint", id: why }, refusal));
    }
    return row;
  }
}

function list(limits: readonly MetLimit[]): string {
  return limits.map(({ words }) => words).join(", ");
}

function group(legend: string, ...rows: HTMLElement[]): HTMLElement {
  return element("fieldset", { "data-group": legend }, element("legend", {}, legend), ...rows);
}
