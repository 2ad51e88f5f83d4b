// Answers from the frames that an exported page has inside. Between frames the strains are interpolated, as `src/grid.rs`
// has it, and the shape is what they add up to: geometry, as everything here.

import { add, rotate, scale, cross } from "./geometry";
import type { Answer, Cloud, Command, Contact, Frame, Pose, Quaternion, Request, Scene, Solved, Strain, Vector } from "./protocol";
import type { Listener, Source } from "./source";
import { valueOf } from "./state";
import { significant } from "./units";

/** As `src/export.rs` writes it. */
export interface Recording {
  scene: Scene;
  axes: number[][];
  models: RecordedModel[];
  moment_laws: MomentLaw[] | null;
  /** Where the tip can go, if the page shows that. */
  cloud?: Cloud;
}

/** What the moments between two stations are of shear, stretch, bending and twist there, the last three less those at rest. */
interface MomentLaw {
  rows: [Strain, Strain, Strain];
  rest: Vector;
}

interface RecordedModel {
  model: string;
  scales: number[];
  strains: string;
  cables: string;
  initial_lengths: number[];
  valid: string;
  contact_counts: string;
  contacts: string;
  objects: number[];
  object_poses: string;
  solved: number;
  greatest_residual: number;
  trials: { count: number; median: number; greatest: number };
}

interface Frames {
  recorded: RecordedModel;
  strains: Int16Array;
  cables: Float32Array;
  valid: Uint8Array;
  contacts: Contact[][];
  objects: Float32Array;
}

function bytes(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;
}

/** The recording in this page, if it is an exported one. */
export function recordingInPage(): Recording | undefined {
  const text = document.getElementById("recording")?.textContent;
  return text ? (JSON.parse(text) as Recording) : undefined;
}

export type Weights = [number, number][];

/** Positions that the interpolation in a slider takes. */
const STENCIL = 4;

/** Lagrange's polynomial through the positions around a value: the share of each, none of them 0. */
function lagrange(values: readonly number[], value: number, stencil: number): Weights {
  const last = values.length - 1;
  const at = Math.min(Math.max(value, values[0]!), values[last]!);
  const nodes = Math.min(stencil, values.length);
  let cell = 0;
  while (cell + 1 < last && values[cell + 1]! <= at) cell++;
  const start = Math.min(Math.max(cell + 1 - Math.floor(nodes / 2), 0), values.length - nodes);
  return Array.from({ length: nodes }, (_, k): [number, number] => {
    let share = 1;
    for (let j = start; j < start + nodes; j++) {
      if (j !== start + k) share *= (at - values[j]!) / (values[start + k]! - values[j]!);
    }
    return [start + k, share];
  }).filter(([, share]) => share !== 0);
}

function tensor(axes: readonly number[][], commands: readonly Command[], stencil: number): Weights {
  let all: Weights = [[0, 1]];
  axes.forEach((values, k) => {
    const each = lagrange(values, valueOf(commands[k]!).value, stencil);
    all = all.flatMap(([frame, weight]) => each.map(([at, share]): [number, number] => [frame * values.length + at, weight * share]));
  });
  return all;
}

/** From 1 where the slider is as in the file to 0 at the distance of two positions. */
function nearness(values: readonly number[], at: number, own: number): number {
  if (values.length < 2) return 1;
  return Math.max(1 - Math.abs(at - own) / (values[1]! - values[0]!), 0);
}

/** The frames that an answer is interpolated from, and the share of each; none where the nearest are not all solved. */
export function around(
  axes: readonly number[][],
  commands: readonly Command[],
  initial: readonly Command[],
  isSolved: (frame: number) => boolean,
): Weights | undefined {
  const own = axes.reduce((product, values) => product * values.length, 1);
  const value = (of: readonly Command[], k: number): number => valueOf(of[k]!).value;
  const near = axes.reduce((product, values, k) => product * nearness(values, value(commands, k), value(initial, k)), 1);
  for (const stencil of [STENCIL, 2]) {
    const all = tensor(axes, commands, stencil);
    if (near > 0) {
      all.push([own, near]);
      for (const [frame, weight] of tensor(axes, initial, stencil)) all.push([frame, -near * weight]);
    }
    if (all.every(([frame]) => isSolved(frame))) return all;
  }
  return undefined;
}

/** Numbers of a touch. */
const TOUCH = 13;

/** The touches of each frame. */
export function contacts(counts: Uint8Array, numbers: Float32Array): Contact[][] {
  let next = 0;
  return Array.from(counts, (count) =>
    Array.from({ length: count }, () => {
      const [obstacle, s, x, y, z, a, b, c, force, f, g, h, sticks] = numbers.subarray(TOUCH * next, TOUCH * ++next);
      return {
        obstacle: obstacle!,
        arc_length: s!,
        point: [x!, y!, z!],
        normal: [a!, b!, c!],
        force: force! < 0 ? null : force!,
        friction: sticks! < 0 ? null : [f!, g!, h!],
        sticks: sticks === 1,
      };
    }),
  );
}

/** Numbers of the pose of a movable object. */
const POSE = 7;

/**
 * The movable objects between frames: the mean of their positions, and of their quaternions, which are alike in neighbouring frames. The first
 * frame that counts says which of the two quaternions of an orientation is meant.
 */
export function objects(numbers: readonly number[], poses: Float32Array, weights: Weights): Solved["objects"] {
  return numbers.map((obstacle, k) => {
    const position: Vector = [0, 0, 0];
    const turn: Quaternion = [0, 0, 0, 0];
    const at = (frame: number): Float32Array => poses.subarray(POSE * (frame * numbers.length + k), POSE * (frame * numbers.length + k + 1));
    const first = at(weights[0]![0]).subarray(3);
    for (const [frame, weight] of weights) {
      const pose = at(frame);
      const alike = pose.subarray(3).reduce((sum, x, i) => sum + x * first[i]!, 0) < 0 ? -weight : weight;
      for (let i = 0; i < 3; i++) position[i]! += weight * pose[i]!;
      for (let i = 0; i < 4; i++) turn[i]! += alike * pose[3 + i]!;
    }
    const size = Math.hypot(...turn);
    return { obstacle, pose: { position, orientation: turn.map((x) => x / size) as Quaternion } };
  });
}

/** The pose reached by moving with a constant body twist, linear and angular: the exponential of SE(3). */
export function move({ position, orientation }: Pose, linear: Vector, angular: Vector): Pose {
  const x = angular[0] ** 2 + angular[1] ** 2 + angular[2] ** 2;
  const phi = Math.sqrt(x);
  // (1 − cos φ)/φ² and (φ − sin φ)/φ³, by their series where they cancel.
  const b = x < 1e-4 ? 0.5 - x / 24 : (1 - Math.cos(phi)) / x;
  const c = x < 1e-4 ? 1 / 6 - x / 120 : (phi - Math.sin(phi)) / (x * phi);
  const once = cross(angular, linear);
  const way = add(linear, add(scale(once, b), scale(cross(angular, once), c)));
  const half = x < 1e-8 ? 0.5 : Math.sin(phi / 2) / phi;
  const turn: Quaternion = [Math.cos(phi / 2), ...scale(angular, half)];
  return { position: add(position, rotate(orientation, way)), orientation: times(orientation, turn) };
}

function times([a, b, c, d]: Quaternion, [w, x, y, z]: Quaternion): Quaternion {
  return [
    a * w - b * x - c * y - d * z,
    a * x + b * w + c * z - d * y,
    a * y - b * z + c * w + d * x,
    a * z + b * y - c * x + d * w,
  ];
}

/** The weighted mean of frames of so many numbers. */
function mean(from: Int16Array | Float32Array, numbers: number, weights: Weights): Float64Array {
  const sum = new Float64Array(numbers);
  for (const [frame, weight] of weights) {
    const at = frame * numbers;
    for (let i = 0; i < numbers; i++) sum[i]! += weight * from[at + i]!;
  }
  return sum;
}

export class Recorded implements Source {
  readonly #recording: Recording;
  readonly #frames: Frames[];
  readonly #listener: Listener;

  constructor(recording: Recording, listener: Listener) {
    this.#recording = recording;
    this.#listener = listener;
    this.#frames = recording.models.map((recorded) => ({
      recorded,
      strains: new Int16Array(bytes(recorded.strains)),
      cables: new Float32Array(bytes(recorded.cables)),
      valid: new Uint8Array(bytes(recorded.valid)),
      contacts: contacts(new Uint8Array(bytes(recorded.contact_counts)), new Float32Array(bytes(recorded.contacts))),
      objects: new Float32Array(bytes(recorded.object_poses)),
    }));
    // As a server does: after the page has been set up.
    queueMicrotask(() => {
      listener.connected(true);
      listener.scene(recording.scene);
    });
  }

  survey(request: Request | undefined): void {
    const { cloud } = this.#recording;
    if (request && cloud) queueMicrotask(() => this.#listener.cloud({ ...cloud, id: request.id }));
  }

  /** An exported page has no courses. */
  play(): void {}

  /** Nor are other holes in it. */
  design(): void {}

  ask(request: Request): void {
    const begun = performance.now();
    const answers = request.models.map((model) => this.#answer(model, request));
    const frame: Frame = { id: request.id, time: (performance.now() - begun) / 1e3, answers, reach: null, cables: null };
    queueMicrotask(() => this.#listener.frame(frame));
  }

  #answer(model: string, request: Request): Answer {
    const frames = this.#frames.find(({ recorded }) => recorded.model === model);
    if (!frames) return { status: "failed", model, message: "it is not in this page" };
    const { axes, scene } = this.#recording;
    const weights = around(axes, request.commands, scene.initial.commands, (frame) => frames.valid[frame] === 1);
    if (!weights) {
      return { status: "failed", model, message: "no solution was found for a frame next to these positions of the sliders" };
    }
    return { status: "solved", ...this.#mix(frames, weights) };
  }

  #mix({ recorded, strains, cables, contacts, objects: placed }: Frames, weights: Weights): Solved {
    const { scene } = this.#recording;
    const pieces = scene.stations.length - 1;
    const count = scene.cables.length;
    const strain = mean(strains, 6 * pieces, weights);
    const cable = mean(cables, 3 * count, weights);
    const [nearest] = weights.reduce((a, b) => (b[1] > a[1] ? b : a));
    const poses: Pose[] = [scene.base];
    const shown: Strain[] = [];
    for (let piece = 0; piece < pieces; piece++) {
      const length = scene.stations[piece + 1]! - scene.stations[piece]!;
      const e = recorded.scales.map((scale, c) => scale * strain[6 * piece + c]!) as [number, number, number, number, number, number];
      const linear: Vector = [e[0] * length, e[1] * length, (1 + e[2]) * length];
      poses.push(move(poses[piece]!, linear, [e[3] * length, e[4] * length, e[5] * length]));
      shown.push([e[3], e[4], e[5], e[0], e[1], e[2]]);
    }
    return {
      model: recorded.model,
      positions: poses.map((pose) => pose.position),
      orientations: poses.map((pose) => pose.orientation),
      strains: shown,
      moments: this.#recording.moment_laws?.map(({ rows, rest }, piece): Vector => momentsOf(rows, rest, shown[piece]!)) ?? null,
      cables: scene.cables.map((_, k) => {
        const tension = cable[3 * k]!;
        const length = cable[3 * k + 1]!;
        const initial = recorded.initial_lengths[k]!;
        return {
          // Negative in a frame stands for none; a little of it is rounding.
          tension: tension < -0.5 ? null : Math.max(tension, 0),
          length,
          initial_length: initial,
          shortening: initial - length,
          slack: cable[3 * k + 2]! > 0.5,
          span_tensions: [],
        };
      }),
      // Those of the nearest frame: contact comes and goes, and has no mean.
      contacts: contacts[nearest]!,
      grasps: [],
      objects: objects(recorded.objects, placed, weights),
      residual: recorded.greatest_residual,
      iterations: 0,
      stability: null,
      unstable: false,
      solve_time: 0,
      driven_by: null,
      compliance: null,
      warnings: [],
    };
  }
}

/** Moments of strains, which come with bending and twist first. */
export function momentsOf(rows: readonly Strain[], rest: Vector, [x, y, z, ...linear]: Strain): Vector {
  const all = [...linear, x - rest[0], y - rest[1], z - rest[2]];
  return rows.map((row) => row.reduce((sum, k, c) => sum + k * all[c]!, 0)) as Vector;
}

/** What an exported page is, in words. */
export function describe({ scene, axes, models }: Recording): string {
  const fixed = axes.filter((values) => values.length === 1).length;
  const positions = Math.max(...axes.map((values) => values.length));
  const words = models.map(({ model, solved, valid, trials }) => {
    const all = bytes(valid).byteLength;
    const missing = solved < all ? ` of ${all} (the others have no solution)` : "";
    const mm = (metres: number): string => significant(metres * 1e3, 2);
    return (
      `${model}: ${solved} solved frames${missing}; between them strains are interpolated, which put the tip ` +
      `${mm(trials.median)} mm off at the median of ${trials.count} trials and ${mm(trials.greatest)} mm at most`
    );
  });
  const moving = fixed === 0 ? "" : ` The sliders of the last ${fixed} cables or motors do not move.`;
  const contact = scene.obstacles.length === 0 ? "" : " Contacts are those of the nearest frame; movable objects are interpolated.";
  return (
    `A page without a server, by whipcord ${scene.version}: ${positions} positions of each slider. ${words.join(". ")}.` +
    `${moving} Loads are those of the file.${contact} Compliance is not in it.`
  );
}
