// Small charts of a quantity along the robot.

import { element, svg } from "./dom";
import { significant } from "./units";

export interface Line {
  label: string;
  colour: string;
  /** Arc length in mm, and the quantity. */
  points: readonly (readonly [number, number])[];
}

const WIDTH = 280;
const HEIGHT = 132;
const LEFT = 46;
const BOTTOM = 30;
const TOP = 8;
const RIGHT = 16;
/** About so many numbers stand at an axis. */
const TICKS = 4;

/** How far apart about so many round numbers from least to most are. */
function stride(least: number, most: number, about: number): number {
  const raw = (most - least) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw * (1 - 1e-9)) ?? raw;
}

/** Round numbers from least to most, about so many. */
export function ticks(least: number, most: number, about: number): number[] {
  const step = stride(least, most, about);
  const first = Math.ceil(least / step - 1e-9);
  const last = Math.floor(most / step + 1e-9);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** What a chart shows from bottom to top: all values, zero, and a tick at either end. */
export function extent(values: readonly number[]): [number, number] {
  const least = Math.min(0, ...values);
  const most = Math.max(0, ...values);
  if (most - least <= 1e-12) return [0, 1];
  const step = stride(least, most, TICKS);
  return [Math.floor(least / step + 1e-9) * step, Math.ceil(most / step - 1e-9) * step];
}

export function chart(title: string, unit: string, lines: readonly Line[], length: number): HTMLElement {
  const values = lines.flatMap((line) => line.points.map(([, y]) => y));
  const [low, high] = extent(values);
  const x = (s: number): number => LEFT + ((WIDTH - LEFT - RIGHT) * s) / length;
  const y = (v: number): number => HEIGHT - BOTTOM - ((HEIGHT - BOTTOM - TOP) * (v - low)) / (high - low);
  const drawn: SVGElement[] = [];
  for (const v of ticks(low, high, TICKS)) {
    drawn.push(
      svg("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v) }),
      svg("text", { x: LEFT - 5, y: y(v) + 3.5, "text-anchor": "end" }, significant(v, 3)),
    );
  }
  for (const s of ticks(0, length, TICKS)) {
    drawn.push(svg("text", { x: x(s), y: HEIGHT - BOTTOM + 13, "text-anchor": "middle" }, significant(s, 3)));
  }
  drawn.push(svg("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 4, "text-anchor": "middle" }, "arc length in mm"));
  for (const line of lines) {
    const points = line.points.map(([s, v]) => `${x(s).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
    drawn.push(svg("polyline", { points, stroke: line.colour, fill: "none", "stroke-width": 1.6 }));
  }
  const [least, most] = [Math.min(...values), Math.max(...values)].map((value) => significant(value, 3));
  const range = values.length > 0 ? `, from ${least} to ${most}` : "";
  const described = `${title} in ${unit} along the robot${range}`;
  const figure = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": described }, ...drawn);
  return element("figure", {}, element("figcaption", {}, `${title} in ${unit}`), figure as unknown as Node);
}
