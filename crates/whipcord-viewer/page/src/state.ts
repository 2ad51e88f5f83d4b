// What the sliders say, how it is kept in the address of the page, and what undo goes back to.

import type { Command, Pull, Request, Scene, Vector } from "./protocol";

/** What the robot is coloured by. */
export const COLOURINGS = ["model", "tension", "curvature", "bending-x", "bending-y", "twist", "strain", "moment", "contact"] as const;
export type Colouring = (typeof COLOURINGS)[number];

/** What dragging the tip does: a force pulls at it, or commands are sought that bring it to the pointer. */
export const DRAGGING = ["force", "reach"] as const;
export type Dragging = (typeof DRAGGING)[number];

export interface State {
  commands: Command[];
  tipForce: Vector;
  tipMoment: Vector;
  gravity: Vector;
  models: string[];
  colouring: Colouring;
  compliance: boolean;
  dragging: Dragging;
  workspace: boolean;
  /** A force at a place of the backbone. */
  pull: Pull | null;
  /** The holes of each cable in place of those of the file, from 1; empty for those of the file. */
  holes: (number[] | null)[];
  /** A wanted shape. */
  sketch: Sketch | null;
}

/** Places of the disks behind the base in the plane of the base's z and x or y, in m. */
export interface Sketch {
  across: "x" | "y";
  points: [number, number][];
}

export function initialState(scene: Scene): State {
  const { commands, tip_force, tip_moment, gravity, models } = scene.initial;
  return {
    commands: commands.map((command) => ({ ...command })),
    tipForce: [...tip_force],
    tipMoment: [...tip_moment],
    gravity: [...gravity],
    models: [...models],
    colouring: "model",
    compliance: false,
    dragging: "force",
    workspace: false,
    pull: null,
    holes: [],
    sketch: null,
  };
}

export function toRequest(state: State, id: number, target: Vector | null = null): Request {
  return {
    id,
    commands: state.commands,
    tip_force: state.tipForce,
    tip_moment: state.tipMoment,
    gravity: state.gravity,
    models: state.models,
    compliance: state.compliance,
    target,
    pull: state.pull,
    holes: state.holes,
  };
}

export function same(a: State, b: State): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}

export type Kind = "tension" | "shortening" | "motor";

/** Kind and value in SI of what a cable or motor is told. */
export function valueOf(command: Command): { kind: Kind; value: number } {
  if ("tension" in command) return { kind: "tension", value: command.tension };
  if ("motor" in command) return { kind: "motor", value: command.motor };
  return { kind: "shortening", value: command.shortening };
}

export function commandOf(kind: Kind, value: number): Command {
  if (kind === "motor") return { motor: value };
  return kind === "tension" ? { tension: value } : { shortening: value };
}

/** How an address begins what is told. */
const LETTERS: Record<Kind, string> = { tension: "t", shortening: "s", motor: "m" };

const text = (value: number): string => String(Number(value.toPrecision(9)));

const pulled = ({ pull }: State): string => (pull ? [pull.arc_length, ...pull.force].map(text).join(",") : "");

const lists = ({ holes }: State): string => holes.map((list) => list?.join("-") ?? "").join(",");

const sketched = ({ sketch }: State): string => (sketch ? [sketch.across, ...sketch.points.flat().map((c) => String(Number(c.toPrecision(5))))].join(",") : "");

/** The state as the part of an address behind `#`, without what is as in the file: between commas nothing stands for that. */
export function toHash(state: State, initial: State): string {
  const parts: string[] = [];
  const put = (key: string, value: string, before: string): void => {
    if (value !== before) parts.push(`${key}=${value}`);
  };
  const each = (key: string, values: readonly string[], before: readonly string[]): void => {
    const changed = values.map((value, i) => (value === before[i] ? "" : value));
    if (changed.some((value) => value !== "")) parts.push(`${key}=${changed.join(",")}`);
  };
  const commands = (of: State): string[] =>
    of.commands.map((command) => {
      const { kind, value } = valueOf(command);
      return `${LETTERS[kind]}${text(value)}`;
    });
  each("cables", commands(state), commands(initial));
  each("force", state.tipForce.map(text), initial.tipForce.map(text));
  each("moment", state.tipMoment.map(text), initial.tipMoment.map(text));
  each("gravity", state.gravity.map(text), initial.gravity.map(text));
  put("models", state.models.join(","), initial.models.join(","));
  put("colour", state.colouring, initial.colouring);
  put("compliance", String(state.compliance), String(initial.compliance));
  put("drag", state.dragging, initial.dragging);
  put("pull", pulled(state), pulled(initial));
  put("holes", lists(state), lists(initial));
  put("sketch", sketched(state), sketched(initial));
  put("workspace", String(state.workspace), String(initial.workspace));
  return parts.join("&");
}

/** Reads an address. What is not said, or makes no sense for this robot, is as in the file. */
export function fromHash(hash: string, scene: Scene): State {
  const state = initialState(scene);
  for (const part of hash.replace(/^#/, "").split("&")) {
    const at = part.indexOf("=");
    const key = part.slice(0, at);
    const value = unescaped(part.slice(at + 1));
    switch (key) {
      case "cables": {
        const words = value.split(",");
        const commands = state.commands.map((own, i) => (words[i] === "" ? own : command(words[i] ?? "?")));
        // A motor keeps being told where to go, and no cable is.
        const fits = (given: Command | undefined, i: number): given is Command =>
          given !== undefined && "motor" in given === "motor" in state.commands[i]!;
        if (words.length === commands.length && commands.every(fits)) state.commands = commands;
        break;
      }
      case "force":
        state.tipForce = vector(value, state.tipForce) ?? state.tipForce;
        break;
      case "moment":
        state.tipMoment = vector(value, state.tipMoment) ?? state.tipMoment;
        break;
      case "gravity":
        state.gravity = vector(value, state.gravity) ?? state.gravity;
        break;
      case "models": {
        const known = scene.models.filter((model) => model.refusal === null).map((model) => model.name);
        const models = value.split(",").filter((name) => known.includes(name));
        if (models.length > 0 || value === "") state.models = [...new Set(models)];
        break;
      }
      case "colour":
        state.colouring = COLOURINGS.find((name) => name === value) ?? state.colouring;
        break;
      case "compliance":
        state.compliance = value === "true";
        break;
      case "drag":
        state.dragging = DRAGGING.find((name) => name === value) ?? state.dragging;
        break;
      case "pull": {
        const [s, x, y, z] = value.split(",").map(number);
        const fits = s !== undefined && x !== undefined && y !== undefined && z !== undefined && s >= 0 && s <= scene.length;
        if (fits) state.pull = { arc_length: s, force: [x, y, z] };
        break;
      }
      case "holes":
        state.holes = holesOf(value, scene) ?? state.holes;
        break;
      case "sketch":
        state.sketch = sketchOf(value, scene) ?? state.sketch;
        break;
      case "workspace":
        state.workspace = value === "true";
        break;
    }
  }
  return state;
}

/** From where and at what the user looks, as the part of an address. */
export function viewToHash(view: readonly number[]): string {
  return `view=${view.map((c) => String(Number(c.toPrecision(5)))).join(",")}`;
}

/** What an address says of it. */
export function viewFromHash(hash: string): number[] | undefined {
  const words = unescaped(hash).match(/(?:^#?|&)view=([^&]*)/)?.[1]?.split(",").map(number);
  if ((words?.length !== 6 && words?.length !== 7) || !words.every((word) => word !== undefined)) return undefined;
  const [x, y, z, a, b, c, height] = words as [number, number, number, number, number, number, number?];
  if (height !== undefined && height <= 0) return undefined;
  return Math.hypot(x - a, y - b, z - c) > 0 ? words : undefined;
}

/** The state of one file in another version of it: what was moved stays, and all else is as the file now has it. */
export function rebase(state: State, initial: State, scene: Scene): State {
  return fromHash(toHash(state, initial), scene);
}

/** What programs that pass an address on have escaped. */
function unescaped(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return "";
  }
}

function command(word: string): Command | undefined {
  const value = number(word.slice(1));
  if (value === undefined) return undefined;
  if (word.startsWith("t")) return { tension: value };
  if (word.startsWith("s")) return { shortening: value };
  if (word.startsWith("m")) return { motor: value };
  return undefined;
}

/** Lists of holes that the disks of a robot have. */
function holesOf(words: string, scene: Scene): State["holes"] | undefined {
  const all = words.split(",").map((list) => (list === "" ? null : list.split("-").map(Number)));
  const fits = (list: number[] | null, cable: number): boolean => {
    if (list === null) return true;
    const own = scene.cables[cable]?.holes;
    const has = (hole: number, disk: number): boolean => Number.isInteger(hole) && hole >= 1 && hole <= (scene.disks[disk]?.holes.length ?? 0);
    return own?.length === list.length && list.every(has);
  };
  return all.length === scene.cables.length && all.every(fits) ? all : undefined;
}

/** A sketch for as many disks as a robot has. */
function sketchOf(words: string, scene: Scene): Sketch | undefined {
  const [across, ...rest] = words.split(",");
  const numbers = rest.map(number);
  if ((across !== "x" && across !== "y") || numbers.length !== 2 * (scene.disks.length - 1)) return undefined;
  if (!numbers.every((c) => c !== undefined)) return undefined;
  const points = Array.from({ length: numbers.length / 2 }, (_, i): [number, number] => [numbers[2 * i]!, numbers[2 * i + 1]!]);
  return { across, points };
}

function vector(words: string, own: Vector): Vector | undefined {
  const [x, y, z, ...more] = words.split(",").map((word, i) => (word === "" ? own[i] : number(word)));
  if (x === undefined || y === undefined || z === undefined || more.length > 0) return undefined;
  return [x, y, z];
}

function number(word: string): number | undefined {
  const value = Number(word);
  return word.trim() !== "" && Number.isFinite(value) ? value : undefined;
}

/** The states that undo and redo go through. */
export class History {
  #past: State[] = [];
  #future: State[] = [];
  #now: State;

  constructor(now: State) {
    this.#now = structuredClone(now);
  }

  /** A change is done with: undo comes back to the state before it. */
  commit(state: State): void {
    if (same(state, this.#now)) return;
    this.#past.push(this.#now);
    if (this.#past.length > MOST_STATES) this.#past.shift();
    this.#future = [];
    this.#now = structuredClone(state);
  }

  undo(): State | undefined {
    return this.#move(this.#past, this.#future);
  }

  redo(): State | undefined {
    return this.#move(this.#future, this.#past);
  }

  /** The same states of another version of the file. */
  rebase(each: (state: State) => State): void {
    this.#now = each(this.#now);
    // What has become the same is no step any more; both lists have the nearest last.
    const steps = (states: State[]): State[] => {
      const all = [...states.map(each), this.#now];
      return all.slice(0, -1).filter((state, i) => !same(state, all[i + 1]!));
    };
    this.#past = steps(this.#past);
    this.#future = steps(this.#future);
  }

  get canUndo(): boolean {
    return this.#past.length > 0;
  }

  get canRedo(): boolean {
    return this.#future.length > 0;
  }

  #move(from: State[], to: State[]): State | undefined {
    const state = from.pop();
    if (state === undefined) return undefined;
    to.push(this.#now);
    this.#now = state;
    return structuredClone(state);
  }
}

const MOST_STATES = 500;
