// Points of the robot in space, from the poses of its cross-sections. No mechanics: that is the server's.

import type { Cable, Quaternion, Scene, Solved, Strain, Vector } from "./protocol";

export function add(a: Vector, b: Vector): Vector {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function scale(a: Vector, f: number): Vector {
  return [a[0] * f, a[1] * f, a[2] * f];
}

export function subtract(a: Vector, b: Vector): Vector {
  return add(a, scale(b, -1));
}

export function norm(a: Vector): number {
  return Math.hypot(...a);
}

export function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** The vector, given in a frame that is turned so, in the frame that is turned from. */
export function rotate([w, x, y, z]: Quaternion, a: Vector): Vector {
  const v: Vector = [x, y, z];
  const once = scale(cross(v, a), 2);
  return add(add(a, scale(once, w)), cross(v, once));
}

export function conjugate([w, x, y, z]: Quaternion): Quaternion {
  return [w, -x, -y, -z];
}

/** How the frame is turned in the world that force and moment at the tip are given in, where the tip is turned so. */
export function tipFrame(scene: Scene, tip: Quaternion): Quaternion {
  if (scene.tip_follower) return tip;
  return loadFrame(scene);
}

/** A point (x, y) of a cross-section in space. */
export function place(solved: Solved, station: number, [x, y]: readonly [number, number]): Vector {
  return add(solved.positions[station]!, rotate(solved.orientations[station]!, [x, y, 0]));
}

/** The pose at an arc length: between stations along the chord, turned as at the nearer one. */
export function poseAt(scene: Scene, solved: Solved, arcLength: number): { position: Vector; orientation: Quaternion } {
  const s = scene.stations;
  let i = 0;
  while (i + 2 < s.length && s[i + 1]! < arcLength) i++;
  const t = Math.min(Math.max((arcLength - s[i]!) / (s[i + 1]! - s[i]!), 0), 1);
  const [a, b] = [solved.positions[i]!, solved.positions[i + 1]!];
  return { position: add(a, scale(subtract(b, a), t)), orientation: solved.orientations[t < 0.5 ? i : i + 1]! };
}

/** How the frame is turned in the world that loads are given in. */
export function loadFrame(scene: Scene): Quaternion {
  return scene.loads_in_base ? scene.base.orientation : [1, 0, 0, 0];
}

/** A cable in space: its points, and the station of each. */
export interface Course {
  points: Vector[];
  stations: number[];
}

/** Where a cable runs: along its course, or straight from disk to disk. One that hangs loose is drawn with a sag outwards. */
export function course(scene: Scene, solved: Solved, cable: Cable, holeToHole: boolean, slack: boolean): Course {
  const last = cable.course.length - 1;
  const knots = new Set([...scene.disks.map((disk) => disk.station), last]);
  const stations: number[] = [];
  for (let i = 0; i <= last; i++) {
    if (slack || !holeToHole || knots.has(i)) stations.push(i);
  }
  const points = stations.map((i) => {
    const [x, y] = cable.course[i]!;
    const out = slack ? 1 + sag(scene, knots, i, last) : 1;
    return place(solved, i, [x * out, y * out]);
  });
  return { points, stations };
}

/** How far a loose cable stands off between two disks, relative to its distance from the axis: a sketch. */
const SAG = 0.3;

function sag(scene: Scene, knots: Set<number>, station: number, last: number): number {
  let before = station;
  while (before > 0 && !knots.has(before)) before--;
  let after = station;
  while (after < last && !knots.has(after)) after++;
  if (before === after) return 0;
  const s = scene.stations;
  const along = (s[station]! - s[before]!) / (s[after]! - s[before]!);
  return SAG * 4 * along * (1 - along);
}

/** Tension in N of a cable at each of these stations: it steps at the disks where it rubs. */
export function tensions(scene: Scene, solved: Solved, index: number, stations: readonly number[]): (number | null)[] {
  const cable = solved.cables[index]!;
  if (cable.span_tensions.length === 0) return stations.map(() => cable.tension);
  return stations.map((station) => {
    let span = scene.disks.findIndex((disk) => disk.station >= station) - 1;
    span = Math.min(Math.max(span, 0), cable.span_tensions.length - 1);
    return cable.span_tensions[span] ?? cable.tension;
  });
}

/** The strains between each two stations; of a model that bends at joints alone their means from disk to disk. */
export function strainsOf(scene: Scene, solved: Solved): Strain[] {
  return overSections(scene, solved, solved.strains);
}

/** What is known between each two stations; of a model that bends at joints alone its means from disk to disk. */
export function overSections<T extends number[]>(scene: Scene, solved: Solved, between: readonly T[]): T[] {
  if (!scene.models.find((choice) => choice.name === solved.model)?.jointed) return [...between];
  const knots = [...new Set([0, ...scene.disks.map((disk) => disk.station), between.length])];
  return knots.slice(1).flatMap((end, k) => {
    const pieces = between.slice(knots[k]!, end);
    const length = (i: number): number => scene.stations[knots[k]! + i + 1]! - scene.stations[knots[k]! + i]!;
    const whole = scene.stations[end]! - scene.stations[knots[k]!]!;
    const mean = pieces[0]!.map((_, c) => pieces.reduce((sum, piece, i) => sum + (piece[c]! * length(i)) / whole, 0)) as T;
    return pieces.map(() => mean);
  });
}

/** A quantity between stations as one at stations: the mean of both sides. */
export function atStations(between: readonly number[]): number[] {
  const last = between.length;
  return Array.from({ length: last + 1 }, (_, i) => {
    const [a, b] = [between[Math.max(i - 1, 0)]!, between[Math.min(i, last - 1)]!];
    return (a + b) / 2;
  });
}
