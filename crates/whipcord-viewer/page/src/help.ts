// What keys and mouse do, and what the numbers mean.

import { element } from "./dom";
import { GLOSSARY } from "./glossary";
import { QUANTITIES } from "./quantities";

const KEYS: readonly [string, string][] = [
  ["Drag the ring at the tip", "pulls at the tip, or moves it: as chosen under Dragging"],
  ["Drag the backbone", "pulls at that place, by a spring to the pointer"],
  ["Drag beside the robot", "turns the view; with the right button or Shift it moves the view"],
  ["Wheel, + and −", "go nearer or farther"],
  ["Press an axis in the corner", "looks along it"],
  ["Arrow keys in the view", "move the view; with Shift they turn it"],
  ["Home or 1, 2, 3, 4", "the whole robot: isometric, from the front, the side and the top"],
  ["0, 5", "the whole robot from here; parallel projection and back"],
  ["Arrow keys in a chart", "read values; + and − zoom, Escape shows all, as does a double click"],
  ["Drag across a chart", "zooms in"],
  ["Ctrl+Z, Ctrl+Shift+Z", "undo and redo"],
  ["?", "this help"],
];

export class Help {
  readonly button = element("button", { type: "button", title: "Keys, and what the numbers mean (?)", "aria-label": "Help" }, "?");
  readonly dialog = element("dialog", { id: "help", "aria-labelledby": "help-title" });

  constructor() {
    const rows = (all: readonly (readonly [string, string])[]): HTMLElement =>
      element("dl", {}, ...all.flatMap(([name, what]) => [element("dt", {}, name), element("dd", {}, what)]));
    const close = element("button", { type: "button", onclick: () => this.dialog.close() }, "Close");
    this.dialog.append(
      element("div", { class: "head" }, element("h2", { id: "help-title" }, "Help"), close),
      element("div", { class: "columns" },
        element("section", {}, element("h3", {}, "Mouse and keys"), rows(KEYS)),
        element("section", {}, element("h3", {}, "Numbers"), rows(Object.entries(GLOSSARY)), element("h3", {}, "Along the robot"),
          rows(QUANTITIES.map(({ title, unit, what }) => [`${title} in ${unit}`, what] as const))),
      ),
    );
    this.button.addEventListener("click", () => this.open());
    // A press beside it shuts it.
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
  }

  open(): void {
    if (!this.dialog.open) this.dialog.showModal();
  }
}
