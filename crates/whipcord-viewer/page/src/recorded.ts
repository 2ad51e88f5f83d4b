// Answers from the frames that an exported page has inside. Between frames the strains are interpolated, linearly in each
// slider, and the shape is what they add up to: geometry, as everything here.

import { add, rotate, scale, cross } from "./geometry";
import type { Answer, Command, Frame, Pose, Quaternion, Request, Scene, Solved, Vector } from "./protocol";
import type { Listener, Source } from "./source";
import { valueOf } from "./state";
import { significant } from "./units";

/** As `src/export.rs` writes it. */
export interface Recording {
  scene: Scene;
  axes: number[][];
  models: RecordedModel[];
}

interface RecordedModel {
  model: string;
  scales: number[];
  strains: string;
  cables: string;
  initial_lengths: number[];
  valid: string;
  solved: number;
  greatest_residual: number;
  trials: { count: number; median: number; greatest: number };
}

interface Frames {
  recorded: RecordedModel;
  strains: Int16Array;
  cables: Float32Array;
  valid: Uint8Array;
}

function bytes(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;
}

/** The recording in this page, if it is an exported one. */
export function recordingInPage(): Recording | undefined {
  const text = document.getElementById("recording")?.textContent;
  return text ? (JSON.parse(text) as Recording) : undefined;
}

/** The frames around what the cables are told, and the share of each. */
export function around(axes: readonly number[][], commands: readonly Command[]): [number, number][] {
  let all: [number, number][] = [[0, 1]];
  axes.forEach((values, k) => {
    const { value } = valueOf(commands[k]!);
    const last = values.length - 1;
    let low = 0;
    while (low + 1 < last && values[low + 1]! <= value) low++;
    const high = Math.min(low + 1, last);
    const width = values[high]! - values[low]!;
    const share = width > 0 ? Math.min(Math.max((value - values[low]!) / width, 0), 1) : 0;
    all = all
      .flatMap(([frame, weight]): [number, number][] => [
        [frame * values.length + low, weight * (1 - share)],
        [frame * values.length + high, weight * share],
      ])
      .filter(([, weight]) => weight > 0);
  });
  return all;
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
    }));
    // As a server does: after the page has been set up.
    queueMicrotask(() => {
      listener.connected(true);
      listener.scene(recording.scene);
    });
  }

  ask(request: Request): void {
    const begun = performance.now();
    const answers = request.models.map((model) => this.#answer(model, request));
    const frame: Frame = { id: request.id, time: (performance.now() - begun) / 1e3, answers };
    queueMicrotask(() => this.#listener.frame(frame));
  }

  #answer(model: string, request: Request): Answer {
    const frames = this.#frames.find(({ recorded }) => recorded.model === model);
    if (!frames) return { status: "failed", model, message: "it is not in this page" };
    const weights = around(this.#recording.axes, request.commands);
    if (weights.some(([frame]) => frames.valid[frame] === 0)) {
      return { status: "failed", model, message: "no solution was found for a frame next to these positions of the sliders" };
    }
    return { status: "solved", ...this.#mix(frames, weights) };
  }

  #mix({ recorded, strains, cables }: Frames, weights: readonly [number, number][]): Solved {
    const { scene } = this.#recording;
    const pieces = scene.stations.length - 1;
    const count = scene.cables.length;
    const mean = (from: Int16Array | Float32Array, stride: number, at: number): number =>
      weights.reduce((sum, [frame, weight]) => sum + weight * from[frame * stride + at]!, 0);
    const poses: Pose[] = [scene.base];
    const shown: Vector[] = [];
    for (let piece = 0; piece < pieces; piece++) {
      const length = scene.stations[piece + 1]! - scene.stations[piece]!;
      const e = recorded.scales.map((scale, c) => scale * mean(strains, 6 * pieces, 6 * piece + c)) as [number, number, number, number, number, number];
      const linear: Vector = [e[0] * length, e[1] * length, (1 + e[2]) * length];
      poses.push(move(poses[piece]!, linear, [e[3] * length, e[4] * length, e[5] * length]));
      shown.push([Math.hypot(e[3], e[4]), e[5], e[2]]);
    }
    return {
      model: recorded.model,
      positions: poses.map((pose) => pose.position),
      orientations: poses.map((pose) => pose.orientation),
      strains: shown,
      cables: scene.cables.map((_, k) => {
        const tension = mean(cables, 3 * count, 3 * k);
        return {
          tension: tension < 0 ? null : tension,
          length: mean(cables, 3 * count, 3 * k + 1),
          initial_length: recorded.initial_lengths[k]!,
          slack: mean(cables, 3 * count, 3 * k + 2) > 0.5,
          span_tensions: [],
        };
      }),
      touches: [],
      residual: recorded.greatest_residual,
      iterations: 0,
      stability: null,
      unstable: false,
      solve_time: 0,
      driven_by: null,
      compliance: null,
    };
  }
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
  const moving = fixed === 0 ? "" : ` The sliders of the last ${fixed} cables do not move.`;
  return (
    `A page without a server, by whipcord ${scene.version}: ${positions} positions of each slider. ${words.join(". ")}.` +
    `${moving} Loads are those of the file; contact forces and compliance are not in it.`
  );
}
