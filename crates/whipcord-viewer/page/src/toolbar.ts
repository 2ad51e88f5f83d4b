// Buttons above the view: from where one looks, and whether bodies are cut open.

import type { Side } from "./cameras";
import { element } from "./dom";
import type { Cut } from "./stage";

export interface Looking {
  look(side: Side | undefined): void;
  parallel(yes: boolean): void;
  cut(cut: Cut | undefined): void;
  /** Keeps the present shape as a ghost, or lets it go. */
  ghost(yes: boolean): void;
}

const SIDES: readonly [Side, string, string][] = [
  ["isometric", "Isometric", "1"],
  ["front", "Front", "2"],
  ["side", "Side", "3"],
  ["top", "Top", "4"],
];

export class Toolbar {
  readonly element = element("div", { id: "looks", role: "toolbar", "aria-label": "Direction of view" });
  readonly #parallel: HTMLButtonElement;
  readonly #ghost: HTMLButtonElement;
  readonly #along = element("select", { id: "cut", "aria-label": "Section cut", title: "Cuts robot and obstacles open across an axis of the world" });
  readonly #at = element("input", { type: "range", id: "cut-at", min: -1, max: 1, step: 0.01, value: 0, "aria-label": "Place of the section cut", hidden: true });
  readonly #looking: Looking;

  constructor(looking: Looking) {
    this.#looking = looking;
    const button = (label: string, title: string, act: () => void): HTMLButtonElement => element("button", { type: "button", title, onclick: act }, label);
    const toggle = (label: string, title: string, act: (yes: boolean) => void): HTMLButtonElement => {
      const made = button(label, title, () => {
        const yes = made.getAttribute("aria-pressed") !== "true";
        made.setAttribute("aria-pressed", String(yes));
        act(yes);
      });
      made.setAttribute("aria-pressed", "false");
      return made;
    };
    this.#parallel = toggle("Orthographic", "Parallel projection, without perspective (5)", (yes) => looking.parallel(yes));
    this.#ghost = toggle("Ghost", "Keeps the present shape in grey, and compares with it", (yes) => looking.ghost(yes));
    for (const [value, label] of [["", "No cut"], ["x", "Cut across x"], ["y", "Cut across y"], ["z", "Cut across z"]] as const) {
      this.#along.append(element("option", { value }, label));
    }
    this.#along.addEventListener("change", () => this.#cut());
    this.#at.addEventListener("input", () => this.#cut());
    this.element.append(
      button("Fit", "The whole robot, from here (0)", () => looking.look(undefined)),
      ...SIDES.map(([side, label, key]) => button(label, `Looks from there at the whole robot (${key})`, () => looking.look(side))),
      this.#parallel,
      this.#ghost,
      this.#along,
      this.#at,
    );
  }

  /** What a key does in the view; whether it does anything. */
  key(key: string): boolean {
    const side = SIDES.find(([, , own]) => own === key)?.[0];
    if (side) this.#looking.look(side);
    else if (key === "0") this.#looking.look(undefined);
    else if (key === "5") this.#parallel.click();
    else return false;
    return true;
  }

  set isParallel(yes: boolean) {
    this.#parallel.setAttribute("aria-pressed", String(yes));
  }

  set hasGhost(yes: boolean) {
    this.#ghost.setAttribute("aria-pressed", String(yes));
  }

  #cut(): void {
    const along = this.#along.value as Cut["along"] | "";
    this.#at.hidden = along === "";
    this.#looking.cut(along === "" ? undefined : { along, at: Number(this.#at.value) });
  }
}
