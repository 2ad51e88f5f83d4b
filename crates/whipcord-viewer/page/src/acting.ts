// What acts on the robot, as arrows and words: in the convention of the static pictures (`crates/whipcord-plot/src/load_marks.rs` and
// `contact_marks.rs`). The longest arrow of a kind stands for its largest load.

import type { Arrow } from "./arrows";
import { TOUCHING } from "./colours";
import { add, loadFrame, norm, poseAt, rotate, scale } from "./geometry";
import type { Label } from "./labels";
import type { Acting, Pull, Scene, Solved, Vector } from "./protocol";
import type { State } from "./state";
import { quantityOf, significant } from "./units";

/** Length of the longest arrow of single forces, of moments, of the teeth of a comb, and of contacts, relative to the robot. */
const FORCE = 0.2;
const MOMENT = 0.15;
const COMB = 0.1;
const CONTACT = 0.16;
/** No arrow is shorter than this part of the longest of its kind. */
const SHORTEST = 0.3;
const SHORTEST_CONTACT = 0.25;
/** A force presses against the tip where less than this part of it, as a cosine, pulls at it. */
const PRESSES = -0.5;
/** Contacts that have their value written beside them: of more the largest. */
const MOST_VALUES = 8;

/** What loads and contacts are drawn by. */
export interface LoadMarks {
  arrows: Arrow[];
  labels: Label[];
  /** Lines from tail to tail of the combs. */
  backs: Vector[][];
  /** Where masses are carried. */
  masses: Vector[];
  /** Places that what is drawn at the robot reaches to. */
  ends: Vector[];
}

/** Loads, with the force that a slider or the pointer has on the backbone. */
export interface Loads extends Acting {
  pull: Pull | null;
}

interface Single {
  kind: "force" | "moment";
  at: Vector;
  vector: Vector;
  follows: boolean;
  presses: boolean;
  words: string;
}

/** The loads of the file and those of the sliders. */
export function loadsOf(scene: Scene, { tipForce, tipMoment, gravity, pull }: State): Loads {
  return { tip_force: tipForce, tip_moment: tipMoment, tip_follower: scene.tip_follower, gravity, loads: scene.loads, pull };
}

/** The loads on one shape, if there are any to be drawn, and the contacts of all. */
export function acting(scene: Scene, loads: Loads | undefined, first: Solved | undefined, contacts: readonly Solved[], ink: string): LoadMarks {
  const made: LoadMarks = { arrows: [], labels: [], backs: [], masses: [], ends: [] };
  if (first && loads) {
    singles(scene, single(scene, loads, first), ink, made);
    spread(scene, loads, first, ink, made);
  }
  touches(scene, contacts, made);
  made.ends = made.arrows.flatMap(({ tail, head }) => [tail, head]);
  if (first && loads) weights(scene, loads, first, ink, made);
  return made;
}

function single(scene: Scene, loads: Loads, first: Solved): Single[] {
  const all: Single[] = [];
  const put = (kind: Single["kind"], s: number, vector: Vector, follows: boolean): void => {
    if (norm(vector) === 0) return;
    const { position, orientation } = poseAt(scene, first, s);
    const along = rotate(orientation, [0, 0, 1]).reduce((sum, c, i) => sum + c * vector[i]!, 0);
    const presses = kind === "force" && s >= scene.length * (1 - 1e-9) && along < PRESSES * norm(vector);
    all.push({ kind, at: position, vector, follows, presses, words: `${kind} ${quantityOf(kind, norm(vector))}` });
  };
  const tip = loads.tip_follower ? first.orientations.at(-1)! : loadFrame(scene);
  put("force", scene.length, rotate(tip, loads.tip_force), loads.tip_follower);
  put("moment", scene.length, rotate(tip, loads.tip_moment), loads.tip_follower);
  if (loads.pull) put("force", loads.pull.arc_length, loads.pull.force, false);
  for (const load of loads.loads) {
    if (load.kind !== "single") continue;
    const frame = load.follows ? poseAt(scene, first, load.arc_length).orientation : loadFrame(scene);
    put("force", load.arc_length, rotate(frame, load.force), load.follows);
    put("moment", load.arc_length, rotate(frame, load.moment), load.follows);
  }
  return all;
}

function singles(scene: Scene, all: readonly Single[], ink: string, made: LoadMarks): void {
  for (const kind of ["force", "moment"] as const) {
    const these = all.filter((load) => load.kind === kind);
    const largest = Math.max(...these.map(({ vector }) => norm(vector)));
    for (const { at, vector, follows, presses, words } of these) {
      const size = norm(vector);
      const longest = scene.length * (kind === "force" ? FORCE : MOMENT);
      const reach = scale(vector, (longest * Math.max(size / largest, SHORTEST)) / size);
      const [tail, head] = presses ? [add(at, scale(reach, -1)), at] : [at, add(at, reach)];
      made.arrows.push({ tail, head, colour: ink, heads: kind === "force" ? 1 : 2, hollow: follows, width: 1.6 });
      made.labels.push({ text: words, at: add(at, scale(reach, presses ? -1.05 : 1.05)), from: at, weight: 3, colour: ink });
    }
  }
}

function spread(scene: Scene, of: Loads, first: Solved, ink: string, made: LoadMarks): void {
  const loads = of.loads.filter((load) => load.kind === "spread");
  for (const kind of ["force", "moment"] as const) {
    const vectors = (load: (typeof loads)[number]): Vector[] => (kind === "force" ? load.forces : load.moments);
    const largest = Math.max(0, ...loads.flatMap(vectors).map(norm));
    if (largest === 0) continue;
    for (const load of loads) {
      const each = vectors(load);
      const most = Math.max(...each.map(norm));
      if (most === 0) continue;
      const back: Vector[] = [];
      load.arc_lengths.forEach((s, k) => {
        const { position, orientation } = poseAt(scene, first, s);
        const vector = rotate(load.follows ? orientation : loadFrame(scene), each[k]!);
        const tail = add(position, scale(vector, (-COMB * scene.length) / largest));
        back.push(tail);
        if (norm(vector) > 0) made.arrows.push({ tail, head: position, colour: ink, heads: kind === "force" ? 1 : 2, hollow: load.follows, width: 0.7 });
      });
      made.backs.push(back);
      const middle = back[Math.floor(back.length / 2)]!;
      const unit = kind === "force" ? "N/m" : "N·m/m";
      made.labels.push({ text: `${kind === "force" ? "load" : "line moment"} ${significant(most, 3)} ${unit}`, at: middle, weight: 2, colour: ink });
    }
  }
}

function weights(scene: Scene, loads: Loads, first: Solved, ink: string, made: LoadMarks): void {
  for (const load of loads.loads) {
    if (load.kind !== "mass" || load.mass === 0) continue;
    const { position } = poseAt(scene, first, load.arc_length);
    made.masses.push(position);
    made.labels.push({ text: `mass ${quantityOf("mass", load.mass)}`, at: add(position, [0, 0, -0.04 * scene.length]), weight: 2, colour: ink });
  }
  const gravity = rotate(loadFrame(scene), loads.gravity);
  const size = norm(gravity);
  if (size === 0) return;
  // Beside the base, above its axes.
  const middle = add(scene.base.position, rotate(loadFrame(scene), scale([-0.3, -0.3, 0.34], scene.length)));
  const half = scale(gravity, (0.07 * scene.length) / size);
  const [from, head] = [add(middle, scale(half, -1)), add(middle, half)];
  made.arrows.push({ tail: from, head, colour: GRAVITY, heads: 1, hollow: false, width: 1.6 });
  made.labels.push({ text: `gravity ${significant(size, 3)} m/s²`, at: add(from, scale(half, -0.1)), from: head, weight: 1, colour: GRAVITY });
}

/** Grey as in the static pictures. */
const GRAVITY = "#7d8590";

function touches(scene: Scene, all: readonly Solved[], made: LoadMarks): void {
  const pushes = all.flatMap(({ contacts }) =>
    contacts.map(({ point, normal, force, friction }) => {
      const push = force === null ? ([0, 0, 0] as Vector) : add(scale(normal, force), friction ?? [0, 0, 0]);
      return { point, push, size: norm(push) };
    }),
  );
  const largest = Math.max(0, ...pushes.map(({ size }) => size));
  const sorted = pushes.filter(({ size }) => size > 0).sort((a, b) => b.size - a.size);
  sorted.forEach(({ point, push, size }, rank) => {
    // It pushes from within the obstacle.
    const tail = add(point, scale(push, (-CONTACT * scene.length * Math.max(size / largest, SHORTEST_CONTACT)) / size));
    made.arrows.push({ tail, head: point, colour: TOUCHING, heads: 1, hollow: false, width: 1.2 });
    if (rank < MOST_VALUES) {
      const beyond = add(tail, scale(push, (-0.01 * scene.length) / size));
      made.labels.push({ text: quantityOf("force", size), at: beyond, from: point, weight: 2 - rank / MOST_VALUES, colour: TOUCHING });
    }
  });
}
