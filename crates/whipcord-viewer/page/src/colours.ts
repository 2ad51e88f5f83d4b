// Colours that people of all kinds of colour vision tell apart.

export type Rgb = readonly [number, number, number];

/** The colours of Okabe and Ito, in the order of the figures that the command line draws. */
const PALETTE = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255", "#999933"] as const;

/** Of what touches an obstacle, and of how that pushes. */
export const TOUCHING = PALETTE[1];
/** Of what the tip is held by, and of the force that pulls at it. */
export const HANDLE = PALETTE[4];

export function paletteColour(index: number): string {
  return PALETTE[index % PALETTE.length] ?? PALETTE[0];
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

/** A colour, each part from 0 to 1, for a value from 0 to 1. */
export function ramp(value: number): Rgb {
  const last = RAMP.length - 1;
  const at = Math.min(Math.max(value, 0), 1) * last;
  const i = Math.min(Math.floor(at), last - 1);
  const [a, b] = [RAMP[i]!, RAMP[i + 1]!];
  const mix = (k: 0 | 1 | 2): number => (a[k] + (b[k] - a[k]) * (at - i)) / 255;
  return [mix(0), mix(1), mix(2)];
}

/** The colours of the ramp from its least to its greatest value, evenly apart. */
export function rampColours(): string[] {
  return RAMP.map((c) => `rgb(${c.join(" ")})`);
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
