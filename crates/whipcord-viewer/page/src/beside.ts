// Robots beside that of the file, each in the latest shape that is known of it.

import type { Answer, Scene, Solved } from "./protocol";
import type { Drawn } from "./robot";
import { Robots } from "./robots";
import type { State } from "./state";

interface Other {
  scene: Scene;
  robots: Robots;
  answer: Answer;
}

export class Beside {
  readonly #others: Other[] = [];

  /** A robot, by its number from 1 on. */
  add(number: number, scene: Scene, answer: Answer): void {
    this.#others[number - 1]?.robots.clear();
    this.#others[number - 1] = { scene, robots: new Robots(), answer };
  }

  /** Shapes of the robots in their order; one without stays as it is. */
  show(answers: readonly (Answer | null)[]): void {
    answers.forEach((answer, k) => {
      const other = this.#others[k];
      if (other && answer) other.answer = answer;
    });
  }

  dress(state: State): void {
    for (const { scene, robots, answer } of this.#others) robots.dress(scene, state, [answer]);
  }

  get groups(): Drawn[] {
    return this.#others.flatMap(({ robots }) => robots.groups);
  }

  get shapes(): Solved[] {
    return this.#others.flatMap(({ robots }) => robots.shapes);
  }
}
