// The panel with the numbers of each answer.

import { element } from "./dom";
import { GLOSSARY } from "./glossary";
import { swatch } from "./legend";
import type { Answer, Grasp, Scene, Solved } from "./protocol";
import { duration, fixed, significant } from "./units";

const mm = (metres: number): string => fixed(metres * 1e3, 3);

export function readout(scene: Scene, answers: readonly Answer[], colourOf: (model: string) => string): HTMLElement[] {
  return answers.map((answer) => section(scene, answer, colourOf(answer.model)));
}

function section(scene: Scene, answer: Answer, colour: string): HTMLElement {
  const heading = element("h2", {}, swatch(colour), answer.model);
  const made = element("section", { class: "answer", "data-model": answer.model, "data-status": answer.status }, heading);
  if (answer.status === "failed") {
    made.append(element("p", { class: "failure" }, answer.message));
    return made;
  }
  const tip = answer.positions.at(-1)!;
  made.dataset["tip"] = JSON.stringify(tip);
  const facts: [string, string][] = [
    ["tip", `(${tip.map(mm).join(", ")}) mm`],
    ["orientation", answer.orientations.at(-1)!.map((c, k) => `${"wxyz"[k]!}\u00a0${fixed(c, 4)}`).join(", ")],
  ];
  if (answer.solve_time === 0 && answer.residual === 0) {
    // A shape of a motion, whose equations are those of the whole step.
  } else if (answer.solve_time > 0) {
    facts.push(["residual", significant(answer.residual, 2)]);
    facts.push(["solve time", `${duration(answer.solve_time)}, ${count(answer.iterations, "iteration")}`]);
  } else {
    // The frames of an exported page were solved before: it has the greatest residual of them.
    facts.push(["residual", `${significant(answer.residual, 2)} at most`]);
  }
  if (answer.stability !== null) facts.push(["stability", significant(answer.stability, 3)]);
  if (answer.driven_by !== null) facts.push(["driven by", `the cable lengths of ${answer.driven_by}`]);
  if (answer.contacts.length > 0) facts.push(["touches", contacts(answer)]);
  for (const grasp of answer.grasps) facts.push([`on ${scene.obstacles[grasp.obstacle]!.name}`, pushed(grasp)]);
  if (answer.compliance?.status === "known") {
    facts.push(["compliance", `${answer.compliance.values.map((v) => significant(v * 1e3, 3)).join(", ")} mm/N, tensions held`]);
    if (answer.compliance.values.every((v) => v > 0)) {
      facts.push(["stiffness", `${answer.compliance.values.map((v) => significant(1e-3 / v, 3)).join(", ")} N/mm, tensions held`]);
    }
  } else if (answer.compliance?.status === "unknown") {
    facts.push(["compliance", answer.compliance.message]);
  }
  const list = element("dl", {});
  for (const [name, value] of facts) {
    const what = GLOSSARY[name] ?? "what the robot exerts on this obstacle: force in N, moment about the origin of its frame in N·mm, and how far the nearest contact is from sliding";
    list.append(element("dt", { title: what }, name), element("dd", { title: what }, value));
  }
  made.append(list);
  if (answer.unstable) {
    made.append(element("p", { class: "failure" }, "Unstable: the robot leaves this shape at the slightest disturbance."));
  }
  for (const { message, help } of answer.warnings) {
    made.append(element("p", { class: "warning" }, element("strong", {}, "Warning: "), `${message}. To do: ${help}.`));
  }
  if (scene.cables.length > 0) made.append(cables(scene, answer));
  if (scene.motors.length > 0 && answer.cables.every((cable) => cable.tension !== null)) made.append(motors(scene, answer));
  return made;
}

function contacts({ contacts: all }: Solved): string {
  const total = all.reduce((sum, touch) => sum + (touch.force ?? 0), 0);
  const stuck = all.filter((touch) => touch.sticks).length;
  const points = `${count(all.length, "point")}${stuck > 0 ? ` (${stuck} stuck by friction)` : ""}`;
  return all.some((touch) => touch.force !== null) ? `${points}, ${significant(total, 3)} N in all` : points;
}

function pushed({ normal_force, force, moment, slip_margin }: Grasp): string {
  // Forces that cancel, or whose line passes the reference point, leave rounding.
  const size = (v: number[]) => (Math.hypot(...v) > 1e-9 * normal_force ? Math.hypot(...v) : 0);
  const margin = slip_margin === null ? "" : `, slip margin ${significant(100 * slip_margin, 3)} %`;
  return `${significant(size(force), 3)} N, ${significant(1e3 * size(moment), 3)} N·mm${margin}`;
}

function count(n: number, one: string): string {
  return `${n} ${one}${n === 1 ? "" : "s"}`;
}

function cables(scene: Scene, solved: Solved): HTMLElement {
  // Of a shape that another program shows the lengths are not known: it has none but those before actuation.
  const isShown = solved.iterations === 0 && solved.solve_time === 0 && solved.residual === 0;
  const rows = solved.cables.map((cable, i) => {
    const known = !isShown || cable.length !== cable.initial_length;
    return [
      scene.cables[i]!.name,
      cable.slack ? "slack" : cable.tension === null ? "–" : significant(cable.tension, 4),
      known ? mm(cable.length) : "–",
      known ? mm(cable.initial_length - cable.length) : "–",
    ];
  });
  return table(["cable", "tension in N", "length in mm", "shortening in mm"], rows);
}

/** What each motor holds, and how much of its limit that is. */
function motors(scene: Scene, solved: Solved): HTMLElement {
  const rows = scene.motors.map(({ name, is_angular, pulls, limit }) => {
    const effort = pulls.reduce((sum, [cable, pull]) => sum + pull * (solved.cables[cable]!.tension ?? 0), 0);
    const shown = is_angular ? `${significant(effort * 1e3, 4)} mN·m` : `${significant(effort, 4)} N`;
    return [name, shown, limit === null || limit === 0 ? "–" : `${significant((100 * Math.abs(effort)) / limit, 3)} %`];
  });
  return table(["motor", "holds", "of its limit"], rows);
}

function table(head: readonly string[], rows: readonly string[][]): HTMLElement {
  const row = ([name, ...values]: string[]): HTMLElement =>
    element("tr", {}, element("th", { scope: "row", title: name! }, name!), ...values.map((value) => element("td", value === "slack" ? { class: "slack" } : {}, value)));
  return element(
    "table",
    {},
    element("thead", {}, element("tr", {}, ...head.map((name) => element("th", { scope: "col", title: GLOSSARY[name] ?? "the name that the file gives it" }, name)))),
    element("tbody", {}, ...rows.map(row)),
  );
}
