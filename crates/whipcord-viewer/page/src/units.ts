// Quantities as people read them: millimetres and newtons outside, SI inside.

export interface Unit {
  /** As it stands beside a number. */
  symbol: string;
  /** As it is spoken. */
  word: string;
  /** What one of it is in SI. */
  si: number;
}

export const NEWTON: Unit = { symbol: "N", word: "newtons", si: 1 };
export const MILLIMETRE: Unit = { symbol: "mm", word: "millimetres", si: 1e-3 };
export const DEGREE: Unit = { symbol: "°", word: "degrees", si: Math.PI / 180 };
export const MILLINEWTON_METRE: Unit = { symbol: "mN·m", word: "millinewton metres", si: 1e-3 };
export const METRE_PER_SECOND_SQUARED: Unit = { symbol: "m/s²", word: "metres per second squared", si: 1 };

/** A number of so many significant digits, without zeros that say nothing, and never in powers of ten between 1e-4 and 1e6. */
export function significant(value: number, digits: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = value.toPrecision(digits);
  if (size >= 1e6 || size < 1e-4) return minus(Number(text).toExponential());
  return minus(String(Number(text)));
}

/** A number with so many decimals. */
export function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return minus(Number(text) === 0 ? (0).toFixed(decimals) : text);
}

function minus(text: string): string {
  return text.replace("-", "−");
}

/** A value in SI as a number of a unit, such as number boxes hold: no digits that only rounding has made. */
export function toUnit(value: number, unit: Unit): number {
  return Number((value / unit.si).toPrecision(12));
}

export function fromUnit(value: number, unit: Unit): number {
  return Number((value * unit.si).toPrecision(15));
}

/** A duration in s in the unit that suits it. */
export function duration(seconds: number): string {
  if (seconds < 1e-3) return `${(seconds * 1e6).toFixed(1)} µs`;
  if (seconds < 1) return `${(seconds * 1e3).toFixed(2)} ms`;
  return `${seconds.toFixed(2)} s`;
}

const SCALES: Record<"force" | "moment" | "mass", readonly (readonly [number, string])[]> = {
  force: [[1e3, "kN"], [1, "N"], [1e-3, "mN"]],
  moment: [[1, "N·m"], [1e-3, "mN·m"], [1e-6, "µN·m"]],
  mass: [[1, "kg"], [1e-3, "g"], [1e-6, "mg"]],
};

/** A positive quantity in SI in the unit that suits it, with three digits. */
export function quantityOf(kind: "force" | "moment" | "mass", value: number): string {
  const scales = SCALES[kind];
  const [si, symbol] = scales.find(([one]) => value >= 0.1 * one) ?? scales.at(-1)!;
  return `${significant(value / si, 3)} ${symbol}`;
}
