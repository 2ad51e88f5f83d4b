// A shape that is sketched in a plane through the base: a target for the holes of a cable, or a table to take away.

import { element, svg } from "./dom";
import { add, rotate } from "./geometry";
import type { Designed, Scene, Vector } from "./protocol";
import type { Sketch, State } from "./state";
import { download } from "./save";
import { significant } from "./units";

export interface SketchChanges {
  change(edit: (state: State) => void): void;
  commit(): void;
  /** Looks for holes that bring the disks to these places. */
  design(places: Vector[], tension: boolean): void;
  name(): string;
}

/** Pixels of the drawing across, and what it shows in lengths of the robot: across to either side, below and above the base. */
const WIDTH = 240;
const ACROSS = 1.1;
const BELOW = 0.45;
const ABOVE = 1.15;
/** A press of an arrow key moves a point by this part of the length, with shift by five times that. */
const STEP = 1 / 180;
/** Passes of the mean of three that take the tremor out of a stroke. */
const SMOOTHING = 8;

type Point = [number, number];

export class Sketcher {
  readonly element = element("fieldset", { "data-group": "Sketch", id: "sketch" });
  readonly #changes: SketchChanges;
  readonly #drawing: SVGElement;
  readonly #line = svg("polyline", { class: "stroke" });
  readonly #dots = svg("g", {});
  readonly #status = element("p", { class: "hint", id: "sketch-status", role: "status" });
  readonly #plane: HTMLSelectElement;
  readonly #tension = element("input", { type: "checkbox", id: "sketch-tension", checked: true });
  readonly #find: HTMLButtonElement;
  readonly #save: HTMLButtonElement;
  readonly #clear: HTMLButtonElement;
  #scene: Scene | undefined;
  #sketch: Sketch | null = null;
  #canDesign = false;
  #stroke: Point[] | undefined;

  constructor(changes: SketchChanges) {
    this.#changes = changes;
    const height = (WIDTH * (BELOW + ABOVE)) / (2 * ACROSS);
    this.#drawing = svg("svg", {
      viewBox: `0 0 ${WIDTH} ${height}`, role: "group", "aria-label": "Drawing of the wanted shape: the base is below, the backbone begins upwards",
    });
    this.#drawing.id = "sketch-plane";
    const [x0, y0] = [WIDTH / 2, (WIDTH * ABOVE) / (2 * ACROSS)];
    this.#drawing.append(
      svg("line", { class: "axis", x1: 0, x2: WIDTH, y1: y0, y2: y0 }), svg("line", { class: "axis", x1: x0, x2: x0, y1: 0, y2: height }),
      svg("rect", { class: "base", x: x0 - 7, y: y0, width: 14, height: 4 }), this.#line, this.#dots,
    );
    this.#plane = element("select", { id: "sketch-of" }, element("option", { value: "x" }, "x and z"), element("option", { value: "y" }, "y and z"));
    this.#plane.addEventListener("change", () => {
      if (!this.#sketch) return;
      this.#edit((sketch) => (sketch.across = this.#plane.value === "y" ? "y" : "x"));
      this.#changes.commit();
    });
    this.#find = this.#button("Find holes", "The list of holes with which the disks come nearest to these places", () => {
      this.tell("Looking for holes…");
      this.#changes.design(this.places(), this.#tension.checked);
    });
    this.#save = this.#button("Download CSV", "The places of the disks, as a target for `whipcord design` and `whipcord reach`", () => this.#download());
    this.#clear = this.#button("Clear", "Take the sketch away", () => {
      this.#changes.change((state) => void (state.sketch = null));
      this.#changes.commit();
    });
    this.#listen();
    this.element.append(
      element("legend", {}, "Sketch a shape"),
      element("div", { class: "choice" }, element("label", { for: "sketch-of" }, "Plane of the base"), this.#plane),
      this.#drawing,
      element("div", { class: "choice" }, this.#tension, element("label", { for: "sketch-tension" }, "The tension may change too")),
      element("div", { class: "pair" }, this.#find, this.#save, this.#clear),
      this.#status,
      element("p", { class: "hint" }, "Draw from the base on; or press a key on a point to move it. The rest of a robot that is longer goes straight on."),
    );
  }

  /** `canDesign`: whether there are holes to look for. */
  open(scene: Scene, canDesign: boolean): void {
    [this.#scene, this.#canDesign] = [scene, canDesign];
    this.tell("");
  }

  show(state: State): void {
    this.#sketch = state.sketch;
    if (!this.#scene) return;
    if (state.sketch) this.#plane.value = state.sketch.across;
    this.#draw();
  }

  tell(words: string): void {
    this.#status.textContent = words;
  }

  designed({ error, largest, proven }: Designed): void {
    const mm = (metres: number): string => `${significant(1e3 * metres, 3)} mm`;
    const known = proven ? "no other list of holes comes nearer" : "there may be a better list";
    this.tell(`${mm(error)} off in the root mean square, ${mm(largest)} at most, by cosserat-disks; with these tensions ${known}.`);
  }

  /** Where the disks behind the base are wanted, in the world; none without a sketch. */
  places(): Vector[] {
    const scene = this.#scene;
    if (!scene || !this.#sketch) return [];
    const { across, points } = this.#sketch;
    return points.map(([u, z]) => add(scene.base.position, rotate(scene.base.orientation, across === "x" ? [u, 0, z] : [0, u, z])));
  }

  /** The places of a straight robot, to begin with. */
  #straight(scene: Scene): Point[] {
    return this.#arcLengths(scene).map((s) => [0, s]);
  }

  /** Of the disks behind the base. */
  #arcLengths(scene: Scene): number[] {
    return scene.disks.slice(1).map(({ station }) => scene.stations[station]!);
  }

  #edit(edit: (sketch: Sketch) => void): void {
    const scene = this.#scene!;
    this.#changes.change((state) => {
      state.sketch ??= { across: this.#plane.value === "y" ? "y" : "x", points: this.#straight(scene) };
      edit(state.sketch);
    });
  }

  #toDrawing([u, z]: Point): Point {
    const scale = WIDTH / (2 * ACROSS * this.#scene!.length);
    return [WIDTH / 2 + scale * u, scale * (ABOVE * this.#scene!.length - z)];
  }

  #toPlane(event: PointerEvent): Point {
    const box = this.#drawing.getBoundingClientRect();
    const scale = (2 * ACROSS * this.#scene!.length) / box.width;
    return [scale * (event.clientX - box.left - box.width / 2), ABOVE * this.#scene!.length - scale * (event.clientY - box.top)];
  }

  #listen(): void {
    this.#drawing.addEventListener("pointerdown", (event) => {
      if (!this.#scene || !(event instanceof PointerEvent) || event.button !== 0 || (event.target as Element).closest("circle")) return;
      event.preventDefault();
      this.#drawing.setPointerCapture(event.pointerId);
      this.#stroke = [[0, 0], this.#toPlane(event)];
    });
    this.#drawing.addEventListener("pointermove", (event) => {
      if (!this.#stroke || !(event instanceof PointerEvent)) return;
      this.#stroke.push(this.#toPlane(event));
      this.#line.setAttribute("points", this.#stroke.map((point) => this.#toDrawing(point).join(",")).join(" "));
    });
    const end = (): void => {
      const stroke = this.#stroke;
      this.#stroke = undefined;
      const scene = this.#scene;
      if (!stroke || !scene) return;
      // A click draws nothing.
      if (stroke.length > 2 && lengthOf(stroke) > 0.05 * scene.length) {
        const points = along(smooth(stroke), this.#arcLengths(scene));
        this.#edit((sketch) => (sketch.points = points));
        this.#changes.commit();
      } else this.#draw();
    };
    this.#drawing.addEventListener("pointerup", end);
    this.#drawing.addEventListener("pointercancel", end);
  }

  #draw(): void {
    const scene = this.#scene!;
    const points = this.#sketch?.points ?? this.#straight(scene);
    this.#line.setAttribute("points", [[0, 0] as Point, ...points].map((point) => this.#toDrawing(point).join(",")).join(" "));
    this.#line.classList.toggle("none", this.#sketch === null);
    this.#find.disabled = this.#sketch === null || !this.#canDesign;
    this.#save.disabled = this.#clear.disabled = this.#sketch === null;
    while (this.#dots.childElementCount > points.length) this.#dots.lastElementChild?.remove();
    points.forEach((point, i) => {
      const [cx, cy] = this.#toDrawing(point).map((c) => Number(c.toFixed(2))) as Point;
      const mm = point.map((c) => significant(1e3 * c, 3));
      const label = `Place of disk ${i + 2}: ${mm[0]} mm across, ${mm[1]} mm along; the arrow keys move it`;
      const dot = this.#dots.children[i] ?? this.#dot(i);
      for (const [key, value] of Object.entries({ cx, cy, "aria-label": label })) dot.setAttribute(key, String(value));
    });
  }

  #dot(i: number): SVGElement {
    const dot = svg("circle", { id: `sketch-disk-${i + 2}`, r: 4, tabindex: 0, role: "button", onkeydown: (event) => this.#key(event as KeyboardEvent, i) });
    let held = false;
    dot.addEventListener("pointerdown", (event) => {
      held = true;
      dot.setPointerCapture(event.pointerId);
      event.stopPropagation();
    });
    dot.addEventListener("pointermove", (event) => {
      if (held) this.#edit((sketch) => (sketch.points[i] = this.#toPlane(event)));
    });
    dot.addEventListener("pointerup", () => {
      held = false;
      this.#changes.commit();
    });
    this.#dots.append(dot);
    return dot;
  }

  #key(event: KeyboardEvent, i: number): void {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const by = STEP * this.#scene!.length * (event.shiftKey ? 5 : 1);
    this.#edit((sketch) => {
      const [u, z] = sketch.points[i]!;
      sketch.points[i] = [u + by * way[0]!, z + by * way[1]!];
    });
    this.#changes.commit();
  }

  #download(): void {
    download(`${this.#changes.name()}-target.csv`, new Blob([csv(this.places())], { type: "text/csv" }));
  }

  #button(label: string, title: string, onclick: () => void): HTMLButtonElement {
    return element("button", { type: "button", title, onclick }, label);
  }
}

/** Places of the disks behind the base as `whipcord design` reads them. */
export function csv(places: readonly Vector[]): string {
  const rows = places.map((place, i) => [i + 2, ...place.map((c) => Number((1e3 * c).toPrecision(9)))].join(","));
  return ["disk,x [mm],y [mm],z [mm]", ...rows, ""].join("\n");
}

function lengthOf(stroke: readonly Point[]): number {
  return stroke.slice(1).reduce((sum, [u, z], i) => sum + Math.hypot(u - stroke[i]![0], z - stroke[i]![1]), 0);
}

/** A stroke without the tremor of the hand; its ends stay. */
export function smooth(stroke: readonly Point[]): Point[] {
  let points = [...stroke];
  for (let pass = 0; pass < SMOOTHING; pass++) {
    const last = points.length - 1;
    const of = points;
    points = of.map((point, i): Point => {
      if (i === 0 || i === last) return point;
      return [0, 1].map((c) => (of[i - 1]![c]! + point[c]! + of[i + 1]![c]!) / 3) as Point;
    });
  }
  return points;
}

/** The points of a stroke at ascending arc lengths; beyond its end it goes straight on. */
export function along(stroke: readonly Point[], arcLengths: readonly number[]): Point[] {
  const points = stroke.filter(([u, z], i) => i === 0 || Math.hypot(u - stroke[i - 1]![0], z - stroke[i - 1]![1]) > 0);
  let [i, passed] = [1, 0];
  const piece = (k: number): number => Math.hypot(points[k]![0] - points[k - 1]![0], points[k]![1] - points[k - 1]![1]);
  return arcLengths.map((s): Point => {
    while (i < points.length - 1 && passed + piece(i) < s) passed += piece(i++);
    const [a, b, t] = [points[i - 1]!, points[i]!, (s - passed) / piece(i)];
    return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
  });
}
