// What the robot is coloured by.

import { cableColour, modelColour, parse, ramp, TOUCHING, type Rgb } from "./colours";
import { atStations, strainsOf, tensions } from "./geometry";
import type { Scene, Solved } from "./protocol";
import { NEUTRAL, type Legend } from "./legend";
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
      const most = Math.max(...known, 0);
      const paint = (of: (number | null)[][]): Paint => ({
        backbone: () => GREY,
        disk: () => DISK,
        cable: (k, i) => {
          const value = of[k]?.[i];
          return value == null ? GREY : ramp(most > 0 ? value / most : 0);
        },
      });
      return { paints: values.map(paint), legend: { title: "tension", unit: "N", least: 0, most, unknown: values.flat(2).includes(null) } };
    }
    case "curvature":
      return onBackbone(scene, all, "curvature", "1/m", ([bend]) => bend, 1);
    case "strain":
      return onBackbone(scene, all, "stretch", "%", ([, , stretch]) => stretch, 100);
    case "contact":
      return { paints: all.map((solved) => byContact(scene, solved)), legend: contactLegend(scene) };
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

function onBackbone(
  scene: Scene,
  all: readonly Solved[],
  title: string,
  unit: string,
  of: (strains: readonly [number, number, number]) => number,
  factor: number,
): { paints: Paint[]; legend: Legend } {
  const values = all.map((solved) => atStations(strainsOf(scene, solved).map(of)));
  const least = Math.min(...values.flat(), 0);
  const most = Math.max(...values.flat(), 0);
  const span = most - least;
  const paint = (along: number[]): Paint => ({
    backbone: (i) => ramp(span > 0 ? (along[i]! - least) / span : 0),
    disk: () => DISK,
    cable: () => GREY,
  });
  return { paints: values.map(paint), legend: { title, unit, least: least * factor, most: most * factor, unknown: false } };
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
