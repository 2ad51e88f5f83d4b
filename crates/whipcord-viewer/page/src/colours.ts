// Colours that people of all kinds of colour vision tell apart.

export type Rgb = readonly [number, number, number];

/** The colour of each model: as in the figures of the command, which define it. */
const MODELS: Readonly<Record<string, string>> = {
  "cosserat": "#0072b2",
  "cosserat-disks": "#d55e00",
  "four-bar": "#009e73",
  "constant-curvature": "#cc79a7",
  "piecewise-constant-curvature": "#e69f00",
  "pseudo-rigid-body": "#56b4e9",
};

/** The colours of cables, none of which is the colour of a model: as in those figures. */
const CABLES = ["#a0522d", "#8e5bd0", "#5c8f1f", "#ee6677", "#01665e", "#c51b7d"] as const;

/** Of what touches an obstacle, and of how that pushes. */
export const TOUCHING = "#c41a1a";
/** Of what the tip is held by, and of the force that pulls at it. */
export const HANDLE = "#e69f00";

/** The colour that a model has wherever it is shown; a variant has that of its model, lighter or darker. */
export function modelColour(name: string): string {
  const own = MODELS[name];
  if (own) return own;
  const model = Object.keys(MODELS).filter((each) => name.startsWith(`${each}-`)).sort((a, b) => b.length - a.length)[0];
  const towards = name.endsWith("-sliding") ? 1 : 0;
  const parts = parse(MODELS[model ?? "cosserat"]!).map((part) => Math.round(255 * (0.6 * part + 0.4 * towards)));
  return `#${parts.map((part) => part.toString(16).padStart(2, "0")).join("")}`;
}

export function cableColour(index: number): string {
  return CABLES[index % CABLES.length] ?? CABLES[0];
}

/** Points of cividis, which rises in lightness and looks nearly the same to all kinds of colour vision (Nuñez et al. 2018). */
const RAMP: Rgb[] = [
  [0, 34, 78],
  [35, 62, 108],
  [87, 93, 109],
  [124, 123, 120],
  [165, 156, 116],
  [211, 193, 100],
  [254, 232, 56],
];

/** Points of a scale for values of both signs, blue below and orange above a light middle, which people of all kinds of colour vision tell
 * apart. */
const DIVERGING: Rgb[] = [
  [5, 48, 97],
  [43, 131, 186],
  [146, 197, 222],
  [236, 236, 232],
  [244, 186, 120],
  [214, 108, 20],
  [127, 50, 0],
];

function along(points: readonly Rgb[], value: number): Rgb {
  const last = points.length - 1;
  const at = Math.min(Math.max(value, 0), 1) * last;
  const i = Math.min(Math.floor(at), last - 1);
  const [a, b] = [points[i]!, points[i + 1]!];
  const mix = (k: 0 | 1 | 2): number => (a[k] + (b[k] - a[k]) * (at - i)) / 255;
  return [mix(0), mix(1), mix(2)];
}

/** A colour, each part from 0 to 1, for a value from 0 to 1. */
export function ramp(value: number): Rgb {
  return along(RAMP, value);
}

/** The same for a value whose middle is zero. */
export function diverging(value: number): Rgb {
  return along(DIVERGING, value);
}

const css = (points: readonly Rgb[]): string[] => points.map((c) => `rgb(${c.join(" ")})`);

/** The colours of the ramp from its least to its greatest value, evenly apart. */
export function rampColours(): string[] {
  return css(RAMP);
}

export function divergingColours(): string[] {
  return css(DIVERGING);
}

/** The colour as light adds up, which is how three.js mixes it. */
export function linear(colour: Rgb): Rgb {
  const [r, g, b] = colour.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return [r!, g!, b!];
}

export function parse(css: string): Rgb {
  const value = Number.parseInt(css.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
