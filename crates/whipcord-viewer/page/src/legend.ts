// What the colours of the robots stand for: in the page, and on pictures that are taken out of it.

import { divergingColours, rampColours } from "./colours";
import { element } from "./dom";
import { significant } from "./units";

/** A ramp of colours, or each by itself. */
export type Legend =
  | { title: string; unit: string; least: number; most: number; unknown: boolean; signed?: boolean }
  | { keys: readonly Key[] };

export interface Key {
  colour: string;
  label: string;
}

/** Of what has no number, or nothing to do with what is shown. */
export const NEUTRAL = "#8c8c8c";

const UNKNOWN: Key = { colour: NEUTRAL, label: "not known" };

/** Of a ramp, evenly apart. */
export function coloursOf({ signed }: { signed?: boolean }): string[] {
  return signed ? divergingColours() : rampColours();
}

/** A patch of a colour. */
export function swatch(colour: string): HTMLElement {
  const made = element("span", { class: "swatch" });
  made.style.background = colour;
  return made;
}

/** A swatch and what it stands for. */
export function key({ colour, label }: Key): HTMLElement {
  return element("span", { class: "key" }, swatch(colour), label);
}

export function keys(all: readonly Key[]): HTMLElement {
  return element("div", { class: "keys" }, ...all.map(key));
}

/** What elements have in them: what is the same is not written again, and needs no new layout. */
const written = new WeakMap<HTMLElement, string>();

/** Writes a legend into an element of the page, which is hidden where there is none. */
export function show(into: HTMLElement, legend: Legend | undefined): void {
  const content = JSON.stringify(legend ?? null);
  if (written.get(into) === content) return;
  written.set(into, content);
  into.hidden = legend === undefined;
  if (!legend) return;
  if ("keys" in legend) return into.replaceChildren(...legend.keys.map(key));
  const bar = element("span", { class: "ramp" });
  bar.style.background = `linear-gradient(to right, ${coloursOf(legend).join(", ")})`;
  into.replaceChildren(
    element("span", {}, `${legend.title} in ${legend.unit}`),
    element("span", {}, significant(legend.least, 3)),
    bar,
    element("span", {}, significant(legend.most, 3)),
    ...(legend.unknown ? [key(UNKNOWN)] : []),
  );
}

/** Draws a legend along the lower edge of a picture that has so many pixels for each of the page. */
export function stamp(context: CanvasRenderingContext2D, legend: Legend, ratio: number, ink: string): void {
  const size = 14 * ratio;
  const middle = context.canvas.height - 1.6 * size;
  context.font = `${size}px system-ui, "Liberation Sans", "DejaVu Sans", sans-serif`;
  context.textBaseline = "middle";
  let x = size;
  const say = (text: string): void => {
    context.fillStyle = ink;
    context.fillText(text, x, middle);
    x += context.measureText(text).width + 0.7 * size;
  };
  const block = (fill: string | CanvasGradient, width: number): void => {
    context.fillStyle = fill;
    context.fillRect(x, middle - size / 2, width, size);
    x += width + 0.5 * size;
  };
  const each = (all: readonly Key[]): void => {
    for (const { colour, label } of all) {
      block(colour, size);
      say(label);
    }
  };
  if ("keys" in legend) return each(legend.keys);
  say(`${legend.title} in ${legend.unit}`);
  say(significant(legend.least, 3));
  const width = 9 * size;
  const ramp = context.createLinearGradient(x, 0, x + width, 0);
  const colours = coloursOf(legend);
  colours.forEach((colour, i) => ramp.addColorStop(i / (colours.length - 1), colour));
  block(ramp, width);
  say(significant(legend.most, 3));
  if (legend.unknown) each([UNKNOWN]);
}
