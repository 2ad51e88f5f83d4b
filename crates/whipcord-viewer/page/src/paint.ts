// What the robot is coloured by.

import { cableColour, diverging, modelColour, parse, ramp, TOUCHING, type Rgb } from "./colours";
import { atStations, tensions } from "./geometry";
import type { Scene, Solved } from "./protocol";
import { NEUTRAL, type Legend } from "./legend";
import { quantity, type Quantity } from "./quantities";
import { GREY, type Paint } from "./robot";
import type { Colouring } from "./state";

const DISK: Rgb = [0.72, 0.74, 0.78];

/** The colours of all robots that are shown, on one scale. */
export function paints(
  scene: Scene,
  all: readonly Solved[],
  colouring: Colouring,
): { paints: Paint[]; legend: Legend | undefined } {
  switch (colouring) {
    case "model":
      return { paints: all.map((solved) => byModel(scene, solved, all.length > 1)), legend: all.length > 1 ? modelLegend(all) : undefined };
    case "tension": {
      const values = all.map((solved) =>
        scene.cables.map((cable, k) => tensions(scene, solved, k, cable.course.map((_, i) => i))),
      );
      const known = values.flat(2).filter((value) => value !== null);
      const [least, most] = fitted(known);
      const paint = (of: (number | null)[][]): Paint => ({
        backbone: () => GREY,
        disk: () => DISK,
        cable: (k, i) => {
          const value = of[k]?.[i];
          return value == null ? GREY : ramp(most > least ? (value - least) / (most - least) : 1);
        },
      });
      return { paints: values.map(paint), legend: { title: "tension", unit: "N", least, most, unknown: values.flat(2).includes(null) } };
    }
    case "contact":
      return { paints: all.map((solved) => byContact(scene, solved)), legend: contactLegend(scene) };
    default:
      return onBackbone(scene, all, quantity(colouring)!);
  }
}

function byModel(scene: Scene, solved: Solved, several: boolean): Paint {
  const own = parse(modelColour(solved.model));
  const cables = scene.cables.map((_, k) => (several ? own : parse(cableColour(k))));
  return {
    backbone: () => (several ? own : [0.35, 0.38, 0.42]),
    disk: () => (several ? mix(own, DISK, 0.7) : DISK),
    cable: (k) => (solved.cables[k]?.slack ? mix(cables[k]!, GREY, 0.75) : cables[k]!),
  };
}

/** From the least to the greatest of the values. */
function fitted(values: readonly number[]): [number, number] {
  if (values.length === 0) return [0, 0];
  const [least, most] = [Math.min(...values), Math.max(...values)];
  // What differs by rounding alone is one value, of which the scale shows how far it is from zero.
  return most - least > 1e-6 * Math.max(Math.abs(least), Math.abs(most)) ? [least, most] : [Math.min(least, 0), Math.max(most, 0)];
}

function onBackbone(scene: Scene, all: readonly Solved[], { title, unit, si, signed, of }: Quantity): { paints: Paint[]; legend: Legend } {
  const values = all.map((solved) => {
    const between = of(scene, solved);
    return between && atStations(between);
  });
  const known = values.flatMap((along) => along ?? []);
  const far = Math.max(...known.map(Math.abs), 0);
  // Colours of what has a sign are centred at zero.
  const [least, most] = signed ? [-far, far] : fitted(known);
  const colour = signed ? diverging : ramp;
  const paint = (along: number[] | undefined): Paint => ({
    backbone: (i) => (along ? colour(most > least ? (along[i]! - least) / (most - least) : 0.5) : GREY),
    disk: () => DISK,
    cable: () => GREY,
  });
  const legend = { title: title.toLowerCase().replace(/κ(.)/, "κ$1"), unit, least: least / si, most: most / si, unknown: values.includes(undefined), signed };
  return { paints: values.map(paint), legend };
}

function modelLegend(all: readonly Solved[]): Legend {
  return { keys: all.map(({ model }) => ({ colour: modelColour(model), label: model })) };
}

function contactLegend(scene: Scene): Legend {
  if (scene.obstacles.length === 0) return { keys: [{ colour: NEUTRAL, label: "there are no obstacles to touch" }] };
  return { keys: [{ colour: TOUCHING, label: "touches, and is pushed along the arrow" }, { colour: NEUTRAL, label: "touches nothing" }] };
}

function byContact(scene: Scene, solved: Solved): Paint {
  const near = scene.length / Math.max(scene.stations.length - 1, 1);
  const touched = (s: number): boolean => solved.contacts.some((touch) => Math.abs(touch.arc_length - s) < 0.75 * near);
  const touching = parse(TOUCHING);
  return {
    backbone: (i) => (touched(scene.stations[i]!) ? touching : GREY),
    disk: (i) => (touched(scene.stations[scene.disks[i]!.station]!) ? touching : DISK),
    cable: () => GREY,
  };
}

function mix(a: Rgb, b: Rgb, share: number): Rgb {
  return [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share];
}
