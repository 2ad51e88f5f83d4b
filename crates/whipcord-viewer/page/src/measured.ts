// What was measured on the real robot beside what the model says: a ball at each marker, and an arrow to it from where the model has it.

import type { Arrow } from "./arrows";
import { add, norm, poseAt, rotate, scale, subtract } from "./geometry";
import type { Label } from "./labels";
import type { Marker, Scene, Solved, Vector } from "./protocol";
import { significant } from "./units";

/** Colour of what was measured: one that no model and no cable has. */
export const MEASURED = "#f0e442";
/** Of the arrows, and the words beside them: the same, dark enough on light ground. */
const ERROR = "#8a7d00";
/** Of the largest errors so many are written. */
const MOST_VALUES = 3;
/** An arrow that is shorter than this, relative to the length, is hidden by its ball. */
const SEEN = 0.002;

export interface Errors {
  balls: Vector[];
  arrows: Arrow[];
  labels: Label[];
  /** Root of the mean square of the errors of those whose place on the robot is known, in m, and how many these are. */
  rms: number | undefined;
  count: number;
  greatest: number;
}

/** The point of a line of sight that is nearest to a place. */
function nearest(origin: Vector, direction: Vector, to: Vector): Vector {
  const away = subtract(to, origin);
  const along = away.reduce((sum, c, i) => sum + c * direction[i]!, 0);
  return add(origin, scale(direction, along));
}

/** The markers beside a shape: of one that a camera saw, the nearest point of its line of sight. */
export function errors(scene: Scene, markers: readonly Marker[], solved: Solved | undefined): Errors {
  const pairs = markers.flatMap(({ seen, arc_length, offset }) => {
    const pose = arc_length !== null && solved ? poseAt(scene, solved, arc_length) : undefined;
    const model = pose && add(pose.position, rotate(pose.orientation, offset));
    if (seen.kind === "position") return [{ at: seen.position, model }];
    // A line has no place of its own: without a model nothing is drawn of it.
    return model ? [{ at: nearest(seen.origin, seen.direction, model), model }] : [];
  });
  const compared = pairs.flatMap(({ at, model }) => (model ? [{ at, model, off: norm(subtract(at, model)) }] : []));
  const greatest = Math.max(0, ...compared.map(({ off }) => off));
  const sorted = [...compared].sort((a, b) => b.off - a.off).filter(({ off }) => off > SEEN * scene.length);
  return {
    balls: pairs.map(({ at }) => at),
    arrows: sorted.map(({ at, model }) => ({ tail: model, head: at, colour: ERROR, heads: 1, hollow: false, width: 0.8 })),
    labels: sorted.slice(0, MOST_VALUES).map(({ at, model, off }) => ({
      text: `${significant(1e3 * off, 2)} mm`,
      at: add(at, scale(subtract(at, model), 0.3)),
      weight: 1.2,
      colour: ERROR,
    })),
    rms: compared.length > 0 ? Math.sqrt(compared.reduce((sum, { off }) => sum + off * off, 0) / compared.length) : undefined,
    count: compared.length,
    greatest,
  };
}

/** The errors in words. */
export function describe({ rms, count, greatest, balls }: Errors): string {
  if (balls.length === 0) return "";
  const all = "measured on the real robot";
  if (rms === undefined) return all;
  const mm = (metres: number): string => significant(1e3 * metres, 3);
  return `${all}: ${count} ${count === 1 ? "marker" : "markers"}, ${mm(rms)} mm RMS, ${mm(greatest)} mm at most`;
}
