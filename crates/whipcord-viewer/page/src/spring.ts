// The spring between a place of the backbone and the pointer. The shape follows its force, and its force the shape: from picture to
// picture the force goes a part of the way to that of the spring, until both agree.

import { add, norm, scale, subtract } from "./geometry";
import type { Vector } from "./protocol";

/** The part of the way at first and at most, and when the force turned back, which says that it went too far. */
const PART = 0.4;
const LESS = 0.5;
const MORE = 1.15;
/** A force that is this near to that of the spring, relative to the range of forces, rests. */
const RESTS = 1e-3;
/** Forces that are tried for one place of the pointer: more say that the shape jumps to and fro, as where the robot buckles. */
const MOST_STEPS = 60;

export class Spring {
  /** What is held, by its number among the stations. */
  readonly station: number;
  /** Where the pointer is. */
  to: Vector;
  /** The force that acts now. */
  force: Vector;
  readonly #before: Vector;
  readonly #stiffness: number;
  readonly #range: number;
  #part = PART;
  #last: Vector = [0, 0, 0];
  /** The force that the last shape was found with. */
  #solvable: Vector;
  #isStopped = false;
  #steps = 0;

  /** A place that is held with a force already; a spring of half the length of the robot pulls with all of `range`. */
  constructor(station: number, at: Vector, before: Vector, range: number, length: number) {
    [this.station, this.to, this.#before, this.force, this.#solvable] = [station, at, before, before, before];
    [this.#stiffness, this.#range] = [(2 * range) / length, range];
  }

  /** Whether there is no shape under a larger force. */
  get isStopped(): boolean {
    return this.#isStopped;
  }

  /** Whether there is no shape in which force and spring agree, of those that the force alone keeps. */
  get isRestless(): boolean {
    return this.#steps > MOST_STEPS;
  }

  move(to: Vector): void {
    this.to = to;
    this.#steps = 0;
    this.#part = Math.max(this.#part, 0.1);
  }

  /** The place is here now: the next force, or none where it rests. */
  next(at: Vector): Vector | undefined {
    this.#solvable = this.force;
    this.#isStopped = false;
    const pulls = add(this.#before, scale(subtract(this.to, at), this.#stiffness));
    const rest = subtract(pulls, this.force);
    if (norm(rest) < RESTS * this.#range) {
      this.#steps = 0;
      return undefined;
    }
    if (this.isRestless || ++this.#steps > MOST_STEPS) return undefined;
    const turnedBack = rest[0] * this.#last[0] + rest[1] * this.#last[1] + rest[2] * this.#last[2] < 0;
    this.#part = Math.min(this.#part * (turnedBack ? LESS : MORE), 1);
    this.#last = rest;
    this.force = add(this.force, scale(rest, this.#part));
    return this.force;
  }

  /** There is no shape under this force: back to the last that had one. */
  back(): Vector {
    this.#isStopped = true;
    this.#part *= LESS;
    this.force = this.#solvable;
    return this.force;
  }
}
