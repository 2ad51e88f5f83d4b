// The holes that cables go through: chosen by clicks on the disks, or by numbers.

import { Vector3, type Camera } from "three";

import { element } from "./dom";
import { place } from "./geometry";
import type { Frame, Scene, Solved, Vector } from "./protocol";
import type { State } from "./state";

export interface HoleChanges {
  state(): State | undefined;
  change(edit: (state: State) => void): void;
  commit(): void;
  /** Other holes can be clicked on, or none any more. */
  redraw(): void;
}

/** How near to a hole a click chooses it, and how far the pointer may move in a click, in pixels of the page. */
const NEAR = 14;
const STILL = 4;

/** Cables that go through holes, with the lists of the file. */
function routed(scene: Scene): number[] {
  const has = scene.disks.some(({ holes }) => holes.length > 0);
  return has ? scene.cables.flatMap(({ holes }, k) => (holes === null ? [] : [k])) : [];
}

export class Holes {
  /** The group of the controls; empty for a robot without holes. */
  readonly element = element("fieldset", { "data-group": "Holes", id: "holes" });
  readonly #changes: HoleChanges;
  #scene: Scene | undefined;
  /** The cables of the file. */
  #own: Scene["cables"] = [];
  #boxes: HTMLInputElement[] = [];
  readonly #list = element("code", { id: "hole-list" });
  #cable = 0;
  #isChoosing = false;

  constructor(changes: HoleChanges) {
    this.#changes = changes;
  }

  /** Whether clicks choose holes. */
  get isChoosing(): boolean {
    return this.#isChoosing;
  }

  /** The cable whose holes are chosen. */
  get cable(): number {
    return this.#cable;
  }

  /** Whether a robot has holes to choose from. */
  get isPossible(): boolean {
    return this.#scene !== undefined && routed(this.#scene).length > 0;
  }

  open(scene: Scene): void {
    [this.#scene, this.#own] = [scene, scene.cables];
    const cables = routed(scene);
    this.element.hidden = cables.length === 0;
    if (!cables.includes(this.#cable)) this.#cable = cables[0] ?? 0;
    if (cables.length === 0) this.#isChoosing = false;
    else this.#build();
  }

  /** Takes where the cables run in a frame. */
  receive(scene: Scene, { cables }: Frame): void {
    scene.cables = cables ?? this.#own;
  }

  /** The holes of a cable from the base on, from 1. */
  of(state: State, cable: number): readonly number[] {
    return state.holes[cable] ?? this.#own[cable]?.holes ?? [];
  }

  /** Gives a cable other holes. */
  put(state: State, cable: number, holes: readonly number[]): void {
    state.holes = put(this.#own.map((one) => one.holes), state.holes, cable, holes);
  }

  show(state: State): void {
    if (!this.#scene || this.element.hidden) return;
    const holes = this.of(state, this.#cable);
    this.#boxes.forEach((box, disk) => {
      if (box !== document.activeElement || Number(box.value) !== holes[disk]) box.value = String(holes[disk] ?? "");
    });
    this.#list.textContent = `holes = [${holes.join(", ")}]`;
  }

  /** The holes that a click can choose, and those that the cable goes through. */
  places(state: State, solved: Solved | undefined): { free: Vector[]; chosen: Vector[] } {
    const scene = this.#scene;
    if (!this.#isChoosing || !scene || !solved) return { free: [], chosen: [] };
    const chosen: Vector[] = [];
    const free: Vector[] = [];
    this.of(state, this.#cable).forEach((own, disk) => {
      const { holes, station } = scene.disks[disk]!;
      holes.forEach((hole, k) => (k + 1 === own ? chosen : free).push(place(solved, station, hole)));
    });
    return { free, chosen };
  }

  /** Lets clicks on a canvas choose holes. */
  listen(canvas: HTMLCanvasElement, camera: () => Camera, solved: () => Solved | undefined): void {
    let down: [number, number] | undefined;
    canvas.addEventListener("pointerdown", (event) => (down = event.button === 0 ? [event.clientX, event.clientY] : undefined), { capture: true });
    canvas.addEventListener("pointerup", (event) => {
      const from = down;
      down = undefined;
      if (!from || !this.#isChoosing || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > STILL) return;
      const shape = solved();
      const found = shape && this.#near(canvas, camera(), shape, event);
      if (found) this.#choose(found.disk, found.hole);
    });
  }

  #choose(disk: number, hole: number): void {
    this.#set(disk, hole);
    this.#changes.commit();
  }

  #set(disk: number, hole: number): void {
    this.#changes.change((state) => {
      const holes = [...this.of(state, this.#cable)];
      holes[disk] = hole;
      this.put(state, this.#cable, holes);
    });
  }

  /** The hole that is seen nearest to the pointer; of those that lie on one another, the one in front. */
  #near(canvas: HTMLCanvasElement, camera: Camera, solved: Solved, event: PointerEvent): { disk: number; hole: number } | undefined {
    const scene = this.#scene!;
    const box = canvas.getBoundingClientRect();
    let best: { disk: number; hole: number } | undefined;
    let least = Infinity;
    const passed = scene.cables[this.#cable]!.holes?.length ?? 0;
    scene.disks.slice(0, passed).forEach(({ holes, station }, disk) =>
      holes.forEach((hole, k) => {
        const { x, y, z } = new Vector3(...place(solved, station, hole)).project(camera);
        const apart = Math.hypot(box.left + ((x + 1) / 2) * box.width - event.clientX, box.top + ((1 - y) / 2) * box.height - event.clientY);
        if (z > 1 || apart > NEAR) return;
        // A pixel counts more than any depth, which is from -1 to 1.
        const worth = Math.round(apart / 4) + 0.1 * z;
        if (worth < least) [least, best] = [worth, { disk, hole: k + 1 }];
      }),
    );
    return best;
  }

  #build(): void {
    const scene = this.#scene!;
    const toggle = element("input", { type: "checkbox", id: "choose-holes", checked: this.#isChoosing });
    toggle.addEventListener("change", () => {
      this.#isChoosing = toggle.checked;
      this.#changes.redraw();
    });
    const cables = routed(scene);
    const select = element(
      "select",
      { id: "holes-cable" },
      ...cables.map((k) => element("option", { value: k, selected: k === this.#cable }, scene.cables[k]!.name)),
    );
    select.addEventListener("change", () => {
      this.#cable = Number(select.value);
      this.#build();
      this.#changes.redraw();
    });
    this.#boxes = (scene.cables[this.#cable]!.holes ?? []).map((_, disk) => {
      const count = scene.disks[disk]!.holes.length;
      const box = element("input", { type: "number", min: 1, max: count, step: 1, id: `hole-${disk + 1}`, "aria-label": `Hole of disk ${disk + 1}` });
      box.addEventListener("input", () => {
        const hole = Number(box.value);
        if (Number.isInteger(hole) && hole >= 1 && hole <= count) this.#set(disk, hole);
      });
      box.addEventListener("change", () => this.#changes.commit());
      return box;
    });
    const each = this.#boxes.map((box, disk) => element("label", {}, `${disk + 1}`, box));
    this.element.replaceChildren(
      element("legend", {}, "Holes"),
      element("div", { class: "choice" }, element("label", { for: "holes-cable" }, "Cable"), select),
      element("div", { class: "choice", title: "A click on a hole of a disk leads the cable through it" }, toggle, element("label", { for: "choose-holes" }, "Choose by clicks on the disks")),
      element("p", { class: "hint" }, "Hole of each disk, from the base:"),
      element("div", { class: "grid-of-boxes" }, ...each),
      element("p", { class: "hint" }, "For the robot file: ", this.#list),
    );
    const state = this.#changes.state();
    if (state) this.show(state);
  }
}

/** Lists of holes with that of one cable changed, beside those of the file: nothing for what is as in the file. */
export function put(own: readonly (readonly number[] | null)[], all: State["holes"], cable: number, holes: readonly number[]): State["holes"] {
  const changed = own.map((_, k) => all[k] ?? null);
  changed[cable] = JSON.stringify(holes) === JSON.stringify(own[cable]) ? null : [...holes];
  return changed.every((list) => list === null) ? [] : changed;
}
