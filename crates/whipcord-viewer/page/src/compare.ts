// One table over all models: where their tips and disks are, how far apart, and how long the solves took.

import { element } from "./dom";
import { norm, subtract } from "./geometry";
import { swatch } from "./legend";
import type { Answer, Scene, Solved, Vector } from "./protocol";
import { duration, fixed, significant } from "./units";

/** What the others are compared with. */
export interface Reference {
  name: string;
  solved: Pick<Solved, "positions">;
}

const COLUMNS: readonly [string, string][] = [
  ["model", "the model, in the colour that it has in the view"],
  ["tip in mm", "place of the tip in the world: x, y, z in mm"],
  ["Δ mm", "distance of the tip from that of the reference, the first row, in mm"],
  ["Δ %", "the same, in per cent of the length of the backbone"],
  ["RMS mm", "root of the mean square of the distances between the disks and those of the reference, in mm"],
  ["time", "time that the solve took"],
];

/** Stands where the others have their differences. */
const REFERENCE = "reference";

export function compare(scene: Scene, answers: readonly Answer[], reference: Reference | undefined, colourOf: (model: string) => string): HTMLElement | undefined {
  const solved = answers.filter((answer) => answer.status === "solved");
  const to: Reference | undefined = reference ?? (solved[0] && { name: solved[0].model, solved: solved[0] });
  if (!to || (answers.length < 2 && !reference)) return undefined;
  const row = (name: string, colour: string | undefined, cells: string[], model?: string): HTMLElement => {
    const made = element("tr", {}, element("th", { scope: "row", title: name }, ...(colour ? [swatch(colour)] : []), name), ...cells.map((cell) => element("td", cell === REFERENCE ? { colspan: 3 } : {}, cell)));
    if (model !== undefined) made.dataset["compared"] = model;
    return made;
  };
  const rows = answers.map((answer) => {
    const { model } = answer;
    if (answer.status === "failed") {
      const made = row(model, colourOf(model), [], model);
      made.append(element("td", { colspan: COLUMNS.length - 1, class: "failure" }, "no solution"));
      return made;
    }
    const tip = answer.positions.at(-1)!;
    const off = norm(subtract(tip, to.solved.positions.at(-1)!));
    const isReference = !reference && to.solved === answer;
    return row(model, colourOf(model), [
      tip.map((c) => fixed(1e3 * c, 1)).join(", "),
      ...(isReference ? [REFERENCE] : [mm(off), significant((100 * off) / scene.length, 3), mm(rootMeanSquare(scene, answer.positions, to.solved.positions))]),
      answer.solve_time > 0 ? duration(answer.solve_time) : "–",
    ], model);
  });
  if (reference) {
    const tip = reference.solved.positions.at(-1)!;
    rows.unshift(row(reference.name, "#9aa3ad", [tip.map((c) => fixed(1e3 * c, 1)).join(", "), REFERENCE, ""]));
  }
  return element(
    "section",
    { id: "compare", "aria-label": "Comparison" },
    element("h2", {}, "Comparison"),
    element(
      "div",
      { class: "wide", tabindex: 0, role: "region", "aria-label": "Table of the comparison" },
      element(
        "table",
        {},
        element("thead", {}, element("tr", {}, ...COLUMNS.map(([name, what]) => element("th", { scope: "col", title: what }, name)))),
        element("tbody", {}, ...rows),
      ),
    ),
  );
}

function mm(metres: number): string {
  return significant(1e3 * metres, 3);
}

/** Over the disks. */
export function rootMeanSquare(scene: Scene, a: readonly Vector[], b: readonly Vector[]): number {
  const squares = scene.disks.map(({ station }) => norm(subtract(a[station]!, b[station]!)) ** 2);
  return Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / squares.length);
}
