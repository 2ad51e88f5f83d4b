// Charts of quantities along the robot, by uPlot: with values under the pointer or the arrow keys, and zoom.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

import { cableColour } from "./colours";
import { element } from "./dom";
import { tensions } from "./geometry";
import type { Scene, Solved } from "./protocol";
import { QUANTITIES } from "./quantities";
import { significant } from "./units";

interface Chart {
  name: string;
  title: string;
  unit: string;
  what: string;
  /** Lines over places along the backbone in mm, the same for all. */
  data(scene: Scene, all: readonly Solved[]): { places: number[]; lines: Line[]; points: boolean };
}

interface Line {
  label: string;
  colour: string;
  values: (number | null)[];
}

/** Both ends of each piece, at which what is constant along it steps. */
function ends({ stations }: Scene): number[] {
  return stations.slice(1).flatMap((s, i) => [1e3 * stations[i]!, 1e3 * s]);
}

const twice = <T>(values: readonly T[]): T[] => values.flatMap((value) => [value, value]);

function charts(colourOf: (model: string) => string): Chart[] {
  return [
    ...QUANTITIES.map((quantity): Chart => ({
      ...quantity,
      data: (scene, all) => ({
        places: ends(scene),
        points: false,
        lines: all.flatMap((solved) => {
          const values = quantity.of(scene, solved);
          return values ? [{ label: solved.model, colour: colourOf(solved.model), values: twice(values.map((value) => value / quantity.si)) }] : [];
        }),
      }),
    })),
    {
      name: "tension", title: "Tension", unit: "N", what: "force in each cable, by the first model that knows tensions; it steps where the cable rubs",
      data: (scene, all) => {
        const first = all.find((solved) => solved.cables.some(({ tension }) => tension !== null));
        const pieces = scene.stations.slice(1).map((_, i) => i + 1);
        return {
          places: ends(scene),
          points: false,
          lines: first
            ? scene.cables.map(({ name, course }, k) => ({
                label: first.cables[k]!.slack ? `${name} (slack)` : name,
                colour: cableColour(k),
                values: twice(tensions(scene, first, k, pieces).map((value, i) => (pieces[i]! < course.length ? value : null))),
              }))
            : [],
        };
      },
    },
    {
      name: "contact", title: "Contact", unit: "N", what: "with how much obstacles push along their normal, where the robot touches them",
      data: (_, all) => {
        const places = [...new Set(all.flatMap(({ contacts }) => contacts.map(({ arc_length }) => 1e3 * arc_length)))].sort((a, b) => a - b);
        return {
          places,
          points: true,
          lines: all.map(({ model, contacts }) => ({
            label: model,
            colour: colourOf(model),
            values: places.map((place) => {
              const there = contacts.filter(({ arc_length, force }) => 1e3 * arc_length === place && force !== null);
              return there.length > 0 ? there.reduce((sum, { force }) => sum + force!, 0) : null;
            }),
          })),
        };
      },
    },
  ];
}

/** Shown until something else is chosen. */
const FIRST = ["bending-x", "bending-y", "tension"];
const HEIGHT = 150;
const SYNC = "whipcord";

export class Charts {
  readonly element = element("section", { id: "charts", "aria-label": "Charts along the robot" });
  readonly #all: Chart[];
  readonly #chosen: Set<string>;
  readonly #buttons: HTMLButtonElement[];
  readonly #plots = new Map<string, { plot: uPlot; lines: string; figure: HTMLElement }>();
  readonly #into = element("div", {});
  readonly #pointed: (arcLength: number | undefined) => void;
  #scene: Scene | undefined;
  #answers: readonly Solved[] = [];
  /** The models of the charts that are shown, and whether they touch something. */
  #models: string | undefined;

  /** `pointed` is told the arc length in m that the pointer is at. */
  constructor(colourOf: (model: string) => string, pointed: (arcLength: number | undefined) => void) {
    this.#all = charts(colourOf);
    this.#pointed = pointed;
    this.#chosen = new Set(FIRST);
    this.#buttons = this.#all.map(({ name, title, unit, what }) => {
      const button = element("button", { type: "button", class: "chip", "aria-pressed": String(this.#chosen.has(name)), title: `${title} in ${unit}: ${what}`, "data-chart": name }, title);
      button.addEventListener("click", () => {
        if (!this.#chosen.delete(name)) this.#chosen.add(name);
        button.setAttribute("aria-pressed", String(this.#chosen.has(name)));
        this.#draw();
      });
      return button;
    });
    this.element.append(
      element("h2", {}, "Along the robot"),
      element("div", { class: "chips", role: "group", "aria-label": "Charts that are shown" }, ...this.#buttons),
      this.#into,
    );
    new ResizeObserver(() => {
      for (const { plot } of this.#plots.values()) plot.setSize({ width: this.#width, height: HEIGHT });
    }).observe(this.element);
  }

  show(scene: Scene, answers: readonly Solved[]): void {
    [this.#scene, this.#answers] = [scene, answers];
    this.element.hidden = answers.length === 0;
    this.#draw();
  }

  /** In other colours. */
  redress(): void {
    for (const name of [...this.#plots.keys()]) this.#remove(name);
    this.#draw();
  }

  get #width(): number {
    return Math.max(this.element.clientWidth, 120);
  }

  #remove(name: string): void {
    const old = this.#plots.get(name);
    old?.plot.destroy();
    old?.figure.remove();
    this.#plots.delete(name);
  }

  #draw(): void {
    const scene = this.#scene;
    if (!scene) return;
    for (const name of this.#plots.keys()) if (!this.#chosen.has(name)) this.#remove(name);
    const models = this.#answers.map(({ model, contacts }) => `${model} ${contacts.length > 0}`).join();
    for (const [i, chart] of this.#all.entries()) {
      // What no model knows, as the moments of a robot without a material, has no chart. Which those are changes with the models alone.
      const isChosen = this.#chosen.has(chart.name);
      if (!isChosen && models === this.#models) continue;
      const { places, lines, points } = chart.data(scene, this.#answers);
      this.#buttons[i]!.disabled = lines.length === 0;
      if (lines.length === 0) this.#remove(chart.name);
      if (!isChosen || lines.length === 0) continue;
      const key = JSON.stringify([scene.length, lines.map(({ label, colour }) => [label, colour])]);
      const known = this.#plots.get(chart.name);
      const data = [places, ...lines.map(({ values }) => values)] as uPlot.AlignedData;
      if (known?.lines === key) {
        // Where the user has zoomed in, that part stays.
        const { min, max } = known.plot.scales["x"]!;
        const zoomed = min != null && max != null && (min > 0 || max < 1e3 * scene.length * (1 - 1e-9));
        known.plot.setData(data, !zoomed);
        if (zoomed) known.plot.redraw();
      } else {
        if (known) this.#remove(chart.name);
        this.#make(chart, lines, points, data, key, 1e3 * scene.length);
      }
      this.#describe(chart, lines);
    }
    this.#models = models;
  }

  #describe({ name, title, unit }: Chart, lines: readonly Line[]): void {
    const values = lines.flatMap((line) => line.values.filter((value) => value !== null));
    const range = values.length > 0 ? `, from ${significant(Math.min(...values), 3)} to ${significant(Math.max(...values), 3)}` : ", nothing known";
    const figure = this.#plots.get(name)?.figure;
    const body = figure?.querySelector(".plot");
    body?.setAttribute("aria-label", `${title} in ${unit} along the robot${range}. Left and right arrow keys read values, plus and minus zoom, Escape shows all.`);
    if (figure) figure.dataset["range"] = range.slice(2);
  }

  #make(chart: Chart, lines: readonly Line[], points: boolean, data: uPlot.AlignedData, key: string, length: number): void {
    const style = getComputedStyle(document.documentElement);
    const [ink, faint, grid] = ["--ink", "--faint", "--line"].map((name) => style.getPropertyValue(name).trim());
    const body = element("div", { class: "plot", tabindex: 0, role: "img" });
    const figure = element("figure", { "data-chart": chart.name }, element("figcaption", { title: chart.what }, `${chart.title} in ${chart.unit}`), body);
    // In the order of the buttons.
    const order = this.#all.map(({ name }) => name);
    const after = [...this.#into.children].find((other) => order.indexOf((other as HTMLElement).dataset["chart"]!) > order.indexOf(chart.name));
    this.#into.insertBefore(figure, after ?? null);
    const axis = { stroke: faint!, grid: { stroke: grid!, width: 1 }, ticks: { stroke: grid!, width: 1, size: 4 }, font: "11px system-ui, sans-serif" };
    const plot = new uPlot({
      width: this.#width,
      height: HEIGHT,
      cursor: { sync: { key: SYNC }, drag: { x: true, y: false }, points: { size: 6 } },
      legend: { live: true },
      scales: {
        x: { time: false, range: (_, least, most) => (data[0].length === 0 || least === null || points ? [0, length] : [least, most]) },
        // Zero is in it, as the sign counts.
        y: { range: (_, least, most) => span(least, most) },
      },
      axes: [
        { ...axis, size: 28, values: (_, ticks) => ticks.map((tick) => significant(tick, 4)) },
        { ...axis, size: 46, values: (_, ticks) => ticks.map((tick) => significant(tick, 3)) },
      ],
      series: [
        { label: "s", value: (_, value) => (value == null ? "–" : `${significant(value, 4)} mm`) },
        ...lines.map(({ label, colour }): uPlot.Series => ({
          label,
          stroke: colour,
          width: 1.8,
          spanGaps: false,
          points: { show: points, size: 7, fill: colour },
          value: (_, value) => (value == null ? "–" : significant(value, 4)),
          ...(points ? { paths: () => null } : {}),
        })),
      ],
      hooks: {
        setCursor: [(plot) => {
          const at = plot.cursor.idx;
          // Each chart of the same pointer says the same.
          const place = at == null || (plot.cursor.left ?? -1) < 0 ? undefined : plot.data[0][at];
          this.#pointed(place === undefined ? undefined : place / 1e3);
        }],
        drawAxes: [(plot) => {
          const zero = plot.valToPos(0, "y", true);
          const { ctx, bbox } = plot;
          ctx.save();
          ctx.strokeStyle = ink!;
          ctx.globalAlpha = 0.45;
          ctx.beginPath();
          ctx.moveTo(bbox.left, zero);
          ctx.lineTo(bbox.left + bbox.width, zero);
          ctx.stroke();
          ctx.restore();
        }],
      },
    }, data, body);
    body.addEventListener("keydown", (event) => keys(event, plot, length));
    this.#plots.set(chart.name, { plot, lines: key, figure });
  }
}

function span(least: number | null, most: number | null): [number, number] {
  const [low, high] = [Math.min(least ?? 0, 0), Math.max(most ?? 0, 0)];
  const size = high - low;
  if (size < 1e-9) return [-1, 1];
  return [low < 0 ? low - 0.08 * size : 0, high > 0 ? high + 0.08 * size : 0];
}

function keys(event: KeyboardEvent, plot: uPlot, length: number): void {
  const last = plot.data[0].length - 1;
  const at = plot.cursor.idx ?? -1;
  const { min, max } = plot.scales["x"]!;
  if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
    // Both ends of a piece are at one place as the next one's.
    const next = Math.min(Math.max(at + (event.key === "ArrowLeft" ? -2 : 2), 0), last);
    const series = plot.series.findIndex((_, k) => k > 0 && plot.data[k]?.[next] != null);
    plot.setCursor({ left: plot.valToPos(plot.data[0][next] ?? 0, "x"), top: series > 0 ? plot.valToPos(plot.data[series]![next]!, "y") : 10 });
  } else if ((event.key === "+" || event.key === "=" || event.key === "-") && min != null && max != null) {
    const middle = plot.data[0][at] ?? (min + max) / 2;
    const half = ((max - min) / 2) * (event.key === "-" ? 2 : 0.5);
    plot.setScale("x", { min: Math.max(middle - half, 0), max: Math.min(middle + half, length) });
  } else if (event.key === "Escape") {
    plot.setScale("x", { min: 0, max: length });
    plot.setCursor({ left: -10, top: -10 });
  } else return;
  event.preventDefault();
}
