// A bar of a round length.

import { significant } from "./units";

/** The longest round bar of at most so many pixels where each metre has `scale` of them. */
export function scaleBar(scale: number, most: number): { pixels: number; words: string } {
  const metres = most / scale;
  const power = 10 ** Math.floor(Math.log10(metres));
  const long = [5, 2, 1].map((digit) => digit * power).find((length) => length <= metres) ?? power;
  return { pixels: long * scale, words: long >= 1 ? `${significant(long, 3)} m` : `${significant(1e3 * long, 3)} mm` };
}
