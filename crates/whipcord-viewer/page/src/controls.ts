// Sliders, models, and what is shown.

import { element } from "./dom";
import { swatch } from "./legend";
import { PlaceBoxes } from "./place";
import type { CableState, MetLimit, ModelChoice, Motor, Reach, Scene, Vector } from "./protocol";
import { quantity } from "./quantities";
import { Slider, type Changes as Changing } from "./slider";
import { COLOURINGS, commandOf, DRAGGING, valueOf, type Colouring, type Dragging, type Kind, type State } from "./state";
import { DEGREE, METRE_PER_SECOND_SQUARED, MILLIMETRE, MILLINEWTON_METRE, NEWTON, significant, type Unit } from "./units";

export interface Changes extends Changing {
  /** Acts once the shape that is shown is the answer to what the sliders say, on what became of a cable in it, if that is known. */
  whenShown(cable: number, act: (present: { tension: number | null; shortening: number } | undefined) => void): void;
  /** The tip is to go to a place in the world. */
  moveTip(to: Vector): void;
}

/** What colours can stand for, as people say it. */
const COLOUR_NAMES: Partial<Record<Colouring, string>> = { model: "model and cable", tension: "tension of cables", contact: "contact" };

const DIRECTIONS = ["x", "y", "z"] as const;

export class Controls {
  readonly #sliders: Slider[];
  readonly #kinds: Kind[];
  readonly #vectors: { of: (state: State) => Vector; each: Slider[] }[];
  readonly #place: Slider;
  readonly #remove: HTMLButtonElement;
  readonly #pull: HTMLElement;
  readonly #models = new Map<string, HTMLInputElement>();
  readonly #colouring: HTMLSelectElement;
  readonly #compliance: HTMLInputElement;
  readonly #workspace: HTMLInputElement;
  readonly #dragging = new Map<Dragging, HTMLInputElement>();
  readonly #tip: PlaceBoxes;
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
    const vector = (name: string, what: string, unit: Unit, reach: number, of: (state: State) => Vector): { of: typeof of; each: Slider[] } => ({
      of,
      each: DIRECTIONS.map((axis, k) =>
        new Slider(axis, `${name}-${axis}`, `${what} along ${axis} in ${unit.symbol}`, unit, [-reach, reach], changes, (state, value) => void (of(state)[k] = value)),
      ),
    });
    const pullOf = (state: State): Vector => (state.pull ??= { arc_length: scene.length / 2, force: [0, 0, 0] }).force;
    this.#vectors = [
      vector("force", "Force at the tip", NEWTON, ranges.force, (state) => state.tipForce),
      vector("moment", "Moment at the tip", MILLINEWTON_METRE, ranges.moment, (state) => state.tipMoment),
      vector("gravity", "Acceleration of gravity", METRE_PER_SECOND_SQUARED, ranges.gravity, (state) => state.gravity),
      vector("pull", "Force on the backbone, in the world,", NEWTON, ranges.force, pullOf),
    ];
    this.#place = new Slider("at", "pull-at", "Where on the backbone it pulls: arc length from the base in mm", MILLIMETRE, [0, scene.length], changes, (state, value) => {
      pullOf(state);
      state.pull!.arc_length = Math.min(Math.max(value, 0), scene.length);
    });
    this.#remove = element("button", { type: "button", onclick: () => {
      changes.change((state) => void (state.pull = null));
      changes.commit();
    } }, "Remove");
    this.#colouring = element(
      "select",
      { id: "colouring", title: "What the colours of the robot stand for; the scale is fitted to the values" },
      ...COLOURINGS.map((name) => element("option", { value: name }, COLOUR_NAMES[name] ?? quantity(name)!.title.toLowerCase())),
    );
    this.#colouring.addEventListener("change", () => {
      changes.change((state) => void (state.colouring = this.#colouring.value as Colouring));
      changes.commit();
    });
    const box = (id: string, edit: (state: State, checked: boolean) => void): HTMLInputElement => {
      const made = element("input", { type: "checkbox", id });
      made.addEventListener("change", () => {
        changes.change((state) => edit(state, made.checked));
        changes.commit();
      });
      return made;
    };
    this.#tip = new PlaceBoxes(scene.length, (to) => changes.moveTip(to));
    this.#tip.show(undefined);
    this.#compliance = box("compliance", (state, checked) => (state.compliance = checked));
    this.#workspace = box("workspace", (state, checked) => (state.workspace = checked));
    const fixed = scene.loads_in_base ? "in the frame of the base" : "in the world";
    const frame = scene.tip_follower ? "in the frame of the tip, with which it turns, as the moment does" : fixed;
    const rows = (k: number): HTMLElement[] => this.#vectors[k]!.each.map(({ row }) => row);
    const hint = (text: string): HTMLElement => element("p", { class: "hint" }, text);
    this.#pull = group("Force on the backbone", this.#place.row, ...rows(3), this.#remove, hint("Drag any place of the backbone, or set it here, in the world."));
    const drag = element(
      "fieldset",
      { "data-group": "Dragging", class: "segments" },
      element("legend", {}, "Dragging"),
      element("div", { class: "segmented" }, ...DRAGGING.map((name) => this.#drag(name, changes))),
      this.#tip.row,
      this.#limits,
    );
    into.replaceChildren(
      ...(axes ? [] : [drag]),
      ...(scene.motors.length > 0 ? [group("Motors", ...this.#rows("motor"))] : []),
      ...(scene.motors.length === 0 || this.#rows("cable").length > 0 ? [group("Cables", ...this.#rows("cable"))] : []),
      this.#choices(scene, axes !== undefined, changes, colourOf),
      group(
        "Show",
        element("div", { class: "choice" }, element("label", { for: "colouring" }, "Colour by"), this.#colouring),
        ...(axes ? [] : [choice(this.#compliance, "Compliance of the tip", "How far a force of 1 N moves the tip in each direction, with the tensions held")]),
        ...(hasCloud ? [
          choice(this.#workspace, "Where the tip can go", "A survey of the workspace of the first model under the present loads"),
          element("p", { class: "hint", id: "cloud", role: "status", hidden: true }),
        ] : []),
      ),
      ...(axes ? [] : [
        group("Force at the tip", ...rows(0), hint(`Drag the tip, or set it here, ${frame}.`)),
        this.#pull,
        group("Moment at the tip", ...rows(1)),
        group("Gravity", ...rows(2)),
      ]),
    );
    axes?.forEach((values, i) => this.#sliders[i]!.bound(values[0]!, values.at(-1)!));
    if (scene.other_loads.length > 0) into.append(hint(`The file also has: ${scene.other_loads.join("; ")}.`));
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
    const pull = state.pull ?? { arc_length: this.#scene.length / 2, force: [0, 0, 0] };
    this.#vectors.forEach(({ of, each }, k) => {
      const vector = k === 3 ? pull.force : of(state);
      each.forEach((slider, c) => slider.show(vector[c]!, anew));
    });
    this.#place.show(pull.arc_length, anew);
    this.#remove.disabled = state.pull === null;
    for (const [name, box] of this.#models) box.checked = state.models.includes(name);
    this.#colouring.value = state.colouring;
    this.#compliance.checked = state.compliance;
    this.#workspace.checked = state.workspace;
    for (const [name, button] of this.#dragging) button.checked = state.dragging === name;
  }

  /** Marks how far each slider had a solution that now has none; nothing where there is one. */
  solvable(last: State | undefined, now: State): void {
    const mark = (slider: Slider, before: number | undefined, present: number): void => slider.solvable(before !== undefined && before !== present ? before : undefined);
    this.#sliders.forEach((slider, i) => {
      const [before, present] = [last?.commands[i], now.commands[i]!];
      const alike = before && valueOf(before).kind === valueOf(present).kind;
      mark(slider, alike ? valueOf(before).value : undefined, valueOf(present).value);
    });
    const vectors: ((state: State) => Vector)[] = [
      (state) => state.tipForce, (state) => state.tipMoment, (state) => state.gravity, (state) => state.pull?.force ?? [0, 0, 0],
    ];
    this.#vectors.forEach(({ each }, k) => each.forEach((slider, c) => mark(slider, last && vectors[k]!(last)[c], vectors[k]!(now)[c]!)));
  }

  /** Where the tip is, if commands are sought that move it. */
  place(tip: Vector | undefined): void {
    this.#tip.show(tip);
  }

  /** Says at the sliders of cables which of them are slack. */
  slack(cables: readonly CableState[] | undefined): void {
    this.#scene.sliders.forEach((slider, i) => {
      if ("cable" in slider) this.#sliders[i]!.badge(cables?.[slider.cable]?.slack ? "slack" : undefined);
    });
  }

  /** Marks the sliders at a limit, and says which limits the robot is at, or why it does not get to the pointer. */
  limits(reach: Reach | null): void {
    const met = reach?.status === "found" ? reach.limits : [];
    this.#sliders.forEach(({ row }, i) => row.classList.toggle("limited", met.some(({ slider }) => slider === i)));
    this.tell(
      reach?.status === "failed" ? reach.message
      : reach && !reach.reached ? `${significant(1e3 * reach.distance, 3)} mm from the target${met.length > 0 ? `, at a limit: ${list(met)}` : ", and no command comes nearer"}`
      : met.length > 0 ? `At a limit: ${list(met)}`
      : "",
    );
  }

  /** What keeps what is dragged from following. */
  tell(words: string): void {
    if (this.#limits.textContent !== words) this.#limits.textContent = words;
    this.#limits.hidden = words === "";
  }

  /** The sliders of cables, or those of motors. */
  #rows(of: "cable" | "motor"): HTMLElement[] {
    return this.#sliders.filter((_, i) => of in this.#scene.sliders[i]!).map(({ row }) => row);
  }

  #motor({ name, is_angular, reach }: Motor, number: number, i: number, changes: Changes): Slider {
    const edit = (state: State, value: number): void => void (state.commands[i] = { motor: value });
    const unit = is_angular ? DEGREE : MILLIMETRE;
    return new Slider(name, `motor-${number}`, `${is_angular ? "Angle" : "Travel"} of the motor ${name} in ${unit.symbol}`, unit, reach, changes, edit);
  }

  #cable(cable: number, i: number, changes: Changes): Slider {
    const { name } = this.#scene.cables[cable]!;
    const toggle = element("button", {
      type: "button",
      class: "unit",
      title: "Pull by tension in N or by length in mm",
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
    const what = `Command of the cable ${name}: its tension in N, or by how many mm it is shortened`;
    return new Slider(name, `cable-${cable}`, what, NEWTON, [0, this.#scene.ranges.tension], changes, edit, toggle);
  }

  #drag(name: Dragging, changes: Changes): HTMLElement {
    const id = `drag-${name}`;
    const button = element("input", { type: "radio", name: "dragging", id, value: name });
    button.addEventListener("change", () => {
      changes.change((state) => void (state.dragging = name));
      changes.commit();
    });
    this.#dragging.set(name, button);
    const [words, what] =
      name === "force"
        ? ["Pull by a force", "A spring between the pointer and the place of the backbone that is held"]
        : ["Move the tip", "Commands are sought that bring the tip to the pointer, or to the numbers below, within the limits"];
    return element("span", { title: what }, button, element("label", { for: id }, words));
  }

  /** The models that take the robot, and behind one line those that do not. */
  #choices(scene: Scene, isExported: boolean, changes: Changes, colourOf: (model: string) => string): HTMLElement {
    const made = group("Models", ...scene.models.filter(({ refusal }) => refusal === null).map((model) => this.#model(model, changes, colourOf(model.name))));
    const refused = scene.models.filter(({ refusal }) => refusal !== null);
    if (refused.length > 0 && !isExported) {
      const words = refused.length === 1 ? "1 model does not take this robot" : `${refused.length} models do not take this robot`;
      made.append(element("details", { id: "refused" }, element("summary", {}, words), ...refused.map((model) => this.#model(model, changes, colourOf(model.name)))));
    }
    return made;
  }

  #model({ name, refusal }: ModelChoice, changes: Changes, colour: string): HTMLElement {
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

function choice(box: HTMLInputElement, words: string, what: string): HTMLElement {
  return element("div", { class: "choice", title: what }, box, element("label", { for: box.id }, words));
}

function list(limits: readonly MetLimit[]): string {
  return limits.map(({ words }) => words).join(", ");
}

function group(legend: string, ...rows: HTMLElement[]): HTMLElement {
  return element("fieldset", { "data-group": legend }, element("legend", {}, legend), ...rows);
}
