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
  /** Looks through the calibrated camera with this number, or through none. */
  through(camera: number | undefined): void;
  /** A photograph that was taken by it. */
  photograph(camera: number, file: File): void;
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
  readonly #camera = element("select", { id: "through", "aria-label": "Calibrated camera", title: "Looks through a camera of the file", hidden: true });
  readonly #photograph = element("input", { type: "file", id: "photograph", accept: "image/*", "aria-label": "Photograph of this camera", hidden: true });
  readonly #choose = element("button", { type: "button", title: "A photograph that this camera took, behind the robot; it stays on this machine", hidden: true }, "Photograph…");
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
    this.#camera.addEventListener("change", () => {
      this.#choose.hidden = this.#camera.value === "";
      looking.through(this.#camera.value === "" ? undefined : Number(this.#camera.value));
    });
    this.#choose.addEventListener("click", () => this.#photograph.click());
    this.#photograph.addEventListener("change", () => {
      const file = this.#photograph.files?.[0];
      if (file && this.#camera.value !== "") looking.photograph(Number(this.#camera.value), file);
      // The same file may be chosen again.
      this.#photograph.value = "";
    });
    this.element.append(
      button("Fit", "The whole robot, from here (0)", () => looking.look(undefined)),
      ...SIDES.map(([side, label, key]) => button(label, `Looks from there at the whole robot (${key})`, () => looking.look(side))),
      this.#parallel,
      this.#ghost,
      this.#along,
      this.#at,
      this.#camera,
      this.#choose,
      this.#photograph,
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

  /** The calibrated cameras of a file, through none of which one looks at first. */
  cameras(names: readonly string[]): void {
    this.#camera.replaceChildren(
      element("option", { value: "" }, "No camera"),
      ...names.map((name, k) => element("option", { value: k }, `Camera ${name}`)),
    );
    this.#camera.hidden = names.length === 0;
    this.leave();
  }

  /** Looks through no calibrated camera any more. */
  leave(): void {
    this.#camera.value = "";
    this.#choose.hidden = true;
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
