// What page and server say to each other, everything in SI: the types of `src/protocol.rs`, which says what they mean.
// `samples.ts` has an example of each message as the server writes it, which the compiler holds against these types.

export type Vector = [number, number, number];
/** (w, x, y, z) */
export type Quaternion = [number, number, number, number];

export type Strain = [number, number, number, number, number, number];

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
  /** A force at a place of the backbone, in the world. */
  pull: Pull | null;
  /** The holes of each cable from the base on, from 1, in place of those of the file; empty for all of the file. */
  holes: (number[] | null)[];
}

export interface DesignRequest {
  request: Request;
  cable: number;
  /** Whether its tension may change as well. */
  tension: boolean;
  /** Of the disks behind the base, in the world. */
  places: Vector[];
}

/** Holes that were found, with what the sliders are to say. */
export interface Designed {
  id: number;
  holes: number[];
  commands: Command[];
  error: number;
  largest: number;
  proven: boolean;
}

export interface Pull {
  arc_length: number;
  force: Vector;
}

/** What can be played: the steps of the file, or its motion over time. */
export type Course = "steps" | "motion";

export interface PlayRequest {
  course: Course;
  request: Request;
}

export type FromPage =
  | ({ type: "solve" } & Request)
  | ({ type: "survey" } & Request)
  | { type: "end_survey" }
  | ({ type: "play" } & PlayRequest)
  | { type: "end_play" }
  | ({ type: "design" } & DesignRequest)
  | { type: "end_design" };

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
  /** From the base on, from 1, where it goes through holes. */
  holes: number[] | null;
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

/** A load of the file, in the frame of the loads, or of the cross-section that it follows. */
export type Load =
  | { kind: "single"; arc_length: number; force: Vector; moment: Vector; follows: boolean }
  | { kind: "spread"; arc_lengths: number[]; forces: Vector[]; moments: Vector[]; follows: boolean }
  | { kind: "mass"; arc_length: number; mass: number };

export interface CourseChoice {
  course: Course;
  count: number;
  /** In s; steps have no times. */
  duration: number | null;
}

export interface Warning {
  message: string;
  help: string;
}

/** A marker that was measured: its place, or the line of sight on which a camera saw it. */
export interface Marker {
  seen: { kind: "position"; position: Vector } | { kind: "line"; camera: number; origin: Vector; direction: Vector };
  /** Where on the robot it sits, where that is known, and where in the frame there. */
  arc_length: number | null;
  offset: Vector;
}

export type Lens =
  | { kind: "pinhole"; focal: [number, number]; centre: [number, number] }
  | { kind: "orthographic"; scale: number; centre: [number, number] };

/** A calibrated camera: z is the direction in which it looks, y is down in the picture. */
export interface Camera {
  name: string;
  pose: Pose;
  lens: Lens;
  size: [number, number];
  columns: number;
  /** Where places of the picture lie without distortion, in pixels, row by row. */
  ideal: ([number, number] | null)[];
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
  loads: Load[];
  /** The same in words. */
  other_loads: string[];
  courses: CourseChoice[];
  /** In each step. */
  measured: Marker[][];
  cameras: Camera[];
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
  /** Between each two stations: bending about x and y, twist, shear along x and y, stretch. */
  strains: Strain[];
  /** Moments of the backbone itself in N·m: bending about x and y, torsion; none where its stiffness is not known. */
  moments: Vector[] | null;
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
  /** The cables with the holes of the request, where these are others than those of the file. */
  cables: Cable[] | null;
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

/** All loads at one time, in the frame of the loads, or of the tip where it says so. */
export interface Acting {
  tip_force: Vector;
  tip_moment: Vector;
  tip_follower: boolean;
  gravity: Vector;
  loads: Load[];
}

/** A shape of a course: at a time in s, or a step by its number from 0. */
export interface Moment {
  time: number;
  answers: Answer[];
  /** What acts on the robot; none where that is the same as at the shape before. */
  acting: Acting | null;
}

/** A part of a course, from this number of its shapes on. */
export interface Track {
  id: number;
  course: Course;
  from: number;
  moments: Moment[];
  complete: boolean;
  /** Why it ends before its end. */
  message: string | null;
}

/** What a program shows at a time in s: a shape of each robot that has one, and where markers are. */
export interface Shown {
  time: number;
  shapes: (Answer | null)[];
  measured: Vector[];
}

export type ToPage =
  | ({ type: "scene" } & Scene)
  | { type: "beside"; number: number; scene: Scene; answer: Answer }
  | ({ type: "shown" } & Shown)
  | { type: "broken"; message: string }
  | ({ type: "frame" } & Frame)
  | ({ type: "cloud" } & Cloud)
  | ({ type: "track" } & Track)
  | { type: "no_cloud"; id: number; message: string }
  | ({ type: "designed" } & Designed)
  | { type: "no_design"; id: number; message: string }
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

/** To play a course; without a request, to end that. */
export function encodePlay(request: PlayRequest | undefined): string {
  const message: FromPage = request ? { type: "play", ...request } : { type: "end_play" };
  return JSON.stringify(message);
}

/** To look for holes. */
export function encodeDesign(request: DesignRequest): string {
  const message: FromPage = { type: "design", ...request };
  return JSON.stringify(message);
}

/** Reads a message of the server, which is of the same version as the page. */
export function decode(text: string): ToPage {
  const message = JSON.parse(text) as ToPage;
  switch (message.type) {
    case "scene":
    case "beside":
    case "shown":
    case "broken":
    case "frame":
    case "cloud":
    case "track":
    case "no_cloud":
    case "designed":
    case "no_design":
    case "error":
      return message;
    default:
      throw new Error(`the server sent a message of an unknown kind: ${text.slice(0, 80)}`);
  }
}
