// What page and server say to each other, everything in SI: the types of `src/protocol.rs`, which says what they mean.
// `samples.ts` has an example of each message as the server writes it, which the compiler holds against these types.

export type Vector = [number, number, number];
/** (w, x, y, z) */
export type Quaternion = [number, number, number, number];

export type Command = { tension: number } | { shortening: number } | { motor: number };

/** What a slider moves: a cable or a motor by its number. */
export type Slider = { cable: number } | { motor: number };

export interface Request {
  id: number;
  commands: Command[];
  tip_force: Vector;
  tip_moment: Vector;
  gravity: Vector;
  models: string[];
  compliance: boolean;
  /** A place for the tip, which commands are sought for. */
  target: Vector | null;
}

export type FromPage = ({ type: "solve" } & Request) | ({ type: "survey" } & Request) | { type: "end_survey" };

export interface Pose {
  position: Vector;
  orientation: Quaternion;
}

export type Section =
  | { kind: "unknown" }
  | { kind: "round"; outer: number[]; inner: number[] }
  | { kind: "rectangle"; width: number[]; height: number[] };

export interface Disk {
  station: number;
  radius: number;
  thickness: number;
  holes: [number, number][];
  hole_radius: number;
}

export interface Cable {
  name: string;
  course: [number, number][];
  initial_length: number;
}

export interface Motor {
  name: string;
  /** Whether it is told an angle in rad and holds a torque in N·m, in contrast to a travel in m and a force in N. */
  is_angular: boolean;
  reach: [number, number];
  /** The cables that it pulls, and what it holds for 1 N in each. */
  pulls: [number, number][];
  limit: number | null;
}

export interface ModelChoice {
  name: string;
  hole_to_hole: boolean;
  jointed: boolean;
  refusal: string | null;
}

export interface Ranges {
  tension: number;
  shortening: number;
  force: number;
  moment: number;
  gravity: number;
}

export type Form =
  | { kind: "half_space" }
  | { kind: "sphere"; radius: number }
  | { kind: "capsule"; radius: number; length: number }
  | { kind: "box"; size: Vector }
  | { kind: "cylinder"; radius: number; length: number }
  | { kind: "pipe"; radius: number; middle: Vector[] }
  | { kind: "superellipsoid"; semi_axes: Vector; exponents: [number, number] }
  | { kind: "mesh"; vertices: Vector[]; triangles: Vector[] };

export interface Obstacle {
  name: string;
  pose: Pose;
  form: Form;
}

export interface Warning {
  message: string;
  help: string;
}

export interface Scene {
  title: string;
  file: string;
  version: string;
  length: number;
  stations: number[];
  section: Section;
  disks: Disk[];
  cables: Cable[];
  motors: Motor[];
  /** What each command of a request is for. */
  sliders: Slider[];
  base: Pose;
  models: ModelChoice[];
  initial: Request;
  ranges: Ranges;
  loads_in_base: boolean;
  tip_follower: boolean;
  other_loads: string[];
  measured: Vector[];
  obstacles: Obstacle[];
  warnings: Warning[];
}

export interface CableState {
  tension: number | null;
  length: number;
  initial_length: number;
  shortening: number;
  slack: boolean;
  span_tensions: number[];
}

export interface Contact {
  obstacle: number;
  arc_length: number;
  point: Vector;
  normal: Vector;
  force: number | null;
  friction: Vector | null;
  sticks: boolean;
}

/** What the robot exerts on an obstacle, all contacts together. */
export interface Grasp {
  obstacle: number;
  contacts: number;
  sliding: number;
  normal_force: number;
  force: Vector;
  moment: Vector;
  /** 0 where a contact slides, 1 where nothing pulls along the surface. */
  slip_margin: number | null;
}

export type Compliance =
  | { status: "known"; values: Vector; directions: [Vector, Vector, Vector] }
  | { status: "unknown"; message: string };

export interface Solved {
  model: string;
  positions: Vector[];
  orientations: Quaternion[];
  /** Between each two stations: curvature of bending, twist, stretch. */
  strains: Vector[];
  cables: CableState[];
  contacts: Contact[];
  grasps: Grasp[];
  /** Movable objects where they are in equilibrium. */
  objects: { obstacle: number; pose: Pose }[];
  residual: number;
  iterations: number;
  stability: number | null;
  unstable: boolean;
  solve_time: number;
  driven_by: string | null;
  compliance: Compliance | null;
  warnings: Warning[];
}

export type Answer =
  | ({ status: "solved" } & Solved)
  | { status: "failed"; model: string; message: string };

/** A limit that is met, and the slider that it is of, if it is of one. */
export interface MetLimit {
  slider: number | null;
  words: string;
}

/** Commands for the place that the tip is dragged to, or for the nearest to it. */
export type Reach =
  | { status: "found"; reached: boolean; commands: Command[]; distance: number; limits: MetLimit[] }
  | { status: "failed"; message: string };

export interface Frame {
  id: number;
  time: number;
  answers: Answer[];
  reach: Reach | null;
}

/** Where the tip can go. */
export interface Cloud {
  id: number;
  voxel: number;
  points: Vector[];
  dexterity: number[];
  /** 3 of a body, 2 of a surface, 1 of a curve. */
  dimension: number;
  measure: number;
  complete: boolean;
}

export type ToPage =
  | ({ type: "scene" } & Scene)
  | { type: "broken"; message: string }
  | ({ type: "frame" } & Frame)
  | ({ type: "cloud" } & Cloud)
  | { type: "no_cloud"; id: number; message: string }
  | { type: "error"; message: string };

export function encode(request: Request): string {
  const message: FromPage = { type: "solve", ...request };
  return JSON.stringify(message);
}

/** To survey where the tip can go; without a request, to end that. */
export function encodeSurvey(request: Request | undefined): string {
  const message: FromPage = request ? { type: "survey", ...request } : { type: "end_survey" };
  return JSON.stringify(message);
}

/** Reads a message of the server, which is of the same version as the page. */
export function decode(text: string): ToPage {
  const message = JSON.parse(text) as ToPage;
  switch (message.type) {
    case "scene":
    case "broken":
    case "frame":
    case "cloud":
    case "no_cloud":
    case "error":
      return message;
    default:
      throw new Error(`the server sent a message of an unknown kind: ${text.slice(0, 80)}`);
  }
}
