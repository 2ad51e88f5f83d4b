// The panel of numbers: the comparison, the charts, and what each model says.

import { Charts } from "./charts";
import { modelColour } from "./colours";
import { compare, type Reference } from "./compare";
import { byId } from "./dom";
import type { Answer, Scene } from "./protocol";
import { readout } from "./readout";
import { drawsBySoftware } from "./sharpness";

/** Times in ms between two states of the numbers, as faster than that nobody reads, and between two of the charts, which take longer to
 * draw. Where the processor also draws the robot it has less time for them while something moves. */
const [READABLE, SEEN] = drawsBySoftware() ? [200, 450] : [100, 220];

export class Panel {
  readonly #charts: Charts;
  #waiting = 0;
  #writtenAt = -Infinity;
  #drawing = 0;
  #drawnAt = -Infinity;
  #next: (() => void) | undefined;
  #draw: (() => void) | undefined;

  constructor(pointed: (arcLength: number | undefined) => void) {
    this.#charts = new Charts(modelColour, pointed);
    byId("charts-place").append(this.#charts.element);
  }

  /** Writes numbers soon, the latest ones. */
  show(scene: Scene, answers: readonly Answer[], reference: Reference | undefined): void {
    this.#next = () => this.#write(scene, answers, reference);
    this.#waiting ||= window.setTimeout(() => {
      this.#waiting = 0;
      this.#writtenAt = performance.now();
      this.#next?.();
    }, READABLE - (performance.now() - this.#writtenAt));
    this.#draw = () => this.#charts.show(scene, answers.filter((answer) => answer.status === "solved"));
    this.#drawing ||= window.setTimeout(() => {
      this.#drawing = 0;
      this.#drawnAt = performance.now();
      this.#draw?.();
    }, SEEN - (performance.now() - this.#drawnAt));
  }

  redress(): void {
    this.#charts.redress();
  }

  #write(scene: Scene, answers: readonly Answer[], reference: Reference | undefined): void {
    const table = compare(scene, answers, reference, modelColour);
    const focused = document.activeElement?.closest("#compare .wide") !== null && document.activeElement !== null;
    byId("comparison").replaceChildren(...(table ? [table] : []));
    if (focused) document.querySelector<HTMLElement>("#compare .wide")?.focus();
    byId("answers").replaceChildren(...readout(scene, answers, modelColour));
  }
}
