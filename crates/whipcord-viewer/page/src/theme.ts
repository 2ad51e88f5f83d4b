// Light and dark: as the system has it, until the user says otherwise.

import { element } from "./dom";

type Choice = "auto" | "light" | "dark";
const CHOICES: readonly Choice[] = ["auto", "light", "dark"];

/** Colours of what surrounds the robot. */
export interface Colours {
  background: string;
  grid: string;
  /** Of lines and letters. */
  ink: string;
}

/** Those of pictures for papers. */
export const PAPER: Colours = { background: "#ffffff", grid: "#cfd5dd", ink: "#1d232b" };

export class Theme {
  readonly button: HTMLButtonElement;
  readonly #system = window.matchMedia("(prefers-color-scheme: dark)");
  readonly #changed: () => void;
  #choice: Choice = "auto";

  constructor(changed: () => void) {
    this.#changed = changed;
    this.button = element("button", { type: "button", onclick: () => this.#next() });
    this.#system.addEventListener("change", () => this.#apply());
    this.#apply();
  }

  get isDark(): boolean {
    return this.#choice === "auto" ? this.#system.matches : this.#choice === "dark";
  }

  get colours(): Colours {
    return this.isDark
      ? { background: "#15191f", grid: "#3a4250", ink: "#e6eaf0" }
      : { background: "#f6f7f9", grid: "#cfd5dd", ink: "#1d232b" };
  }

  #next(): void {
    this.#choice = CHOICES[(CHOICES.indexOf(this.#choice) + 1) % CHOICES.length] ?? "auto";
    this.#apply();
  }

  #apply(): void {
    document.documentElement.dataset["theme"] = this.isDark ? "dark" : "light";
    this.button.textContent = `Colours: ${this.#choice}`;
    this.#changed();
  }
}
