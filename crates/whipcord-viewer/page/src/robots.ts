// The robots in the view, one for each model: in the shape of its answer or, greyed, in the last one that it had.

import type { Object3D } from "three";

import { ellipsoid } from "./ellipsoid";
import { modelColour, TOUCHING } from "./colours";
import { place } from "./geometry";
import type { Label } from "./labels";
import type { Legend } from "./legend";
import { paints } from "./paint";
import type { Answer, Scene, Solved } from "./protocol";
import { GREY, RobotMesh, type Drawn } from "./robot";
import type { State } from "./state";

export class Robots {
  readonly #shown = new Map<string, { mesh: RobotMesh; solved: Solved }>();
  #ghost: { mesh: RobotMesh; solved: Solved } | undefined;

  /** Without any robot: of another file. */
  clear(): void {
    for (const { mesh } of this.#shown.values()) mesh.dispose();
    this.#shown.clear();
    this.pin(undefined, undefined);
  }

  /** Shapes for answers, and what their colours stand for. */
  dress(scene: Scene, state: State, answers: readonly Answer[]): Legend | undefined {
    const solved = answers.filter((answer) => answer.status === "solved");
    const asked = answers.map((answer) => answer.model);
    for (const [model, { mesh }] of this.#shown) {
      if (asked.includes(model)) continue;
      mesh.dispose();
      this.#shown.delete(model);
    }
    const { paints: colours, legend } = paints(scene, solved, state.colouring);
    solved.forEach((answer, i) => {
      const shown = this.#shown.get(answer.model) ?? { mesh: new RobotMesh(scene, answer.model), solved: answer };
      shown.solved = answer;
      shown.mesh.update(answer, colours[i]!);
      this.#shown.set(answer.model, shown);
    });
    for (const [model, { mesh }] of this.#shown) mesh.stale = !solved.some((answer) => answer.model === model);
    return legend;
  }

  has(model: string): boolean {
    return this.#shown.has(model);
  }

  get groups(): Drawn[] {
    return [...this.#shown.values()].map(({ mesh }) => mesh.group);
  }

  /** Those whose shape is an answer, in their parts. */
  get answered(): Object3D[] {
    return [...this.#shown.values()].filter(({ mesh }) => !mesh.stale).map(({ mesh }) => mesh.group.parts());
  }

  get shapes(): Solved[] {
    return [...this.#shown.values()].map(({ solved }) => solved);
  }

  /** Keeps a shape as a ghost that others are compared with, or none any more. */
  pin(scene: Scene | undefined, solved: Solved | undefined): Drawn | undefined {
    this.#ghost?.mesh.dispose();
    this.#ghost = undefined;
    if (!scene || !solved) return undefined;
    const mesh = new RobotMesh(scene, solved.model);
    mesh.update(solved, { backbone: () => GREY, cable: () => GREY, disk: () => GREY });
    mesh.stale = true;
    mesh.group.name = "ghost";
    this.#ghost = { mesh, solved };
    return mesh.group;
  }

  get pinned(): Solved | undefined {
    return this.#ghost?.solved;
  }
}

/** Ellipsoids of how the tips yield. */
export function ellipsoids(scene: Scene, solved: readonly Solved[]): Object3D[] {
  const most = Math.max(...solved.flatMap(({ compliance }) => (compliance?.status === "known" ? compliance.values : [])));
  const bodies = solved.map(({ compliance, positions, model }) =>
    compliance ? ellipsoid(compliance, most, positions.at(-1)!, scene, modelColour(model)) : undefined,
  );
  return bodies.filter((body) => body !== undefined);
}

/** Says at slack cables that they are. */
export function slackLabels(scene: Scene, solved: Solved | undefined): Label[] {
  if (!solved) return [];
  return solved.cables.flatMap(({ slack }, k): Label[] => {
    const { course, name } = scene.cables[k]!;
    const station = Math.floor(course.length / 2);
    const [x, y] = course[station]!;
    return slack ? [{ text: `${name} is slack`, at: place(solved, station, [1.5 * x, 1.5 * y]), weight: 1.5, colour: TOUCHING }] : [];
  });
}
