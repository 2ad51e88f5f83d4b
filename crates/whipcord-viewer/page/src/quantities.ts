// What varies along the backbone: for charts and for colours.

import { overSections, strainsOf } from "./geometry";
import type { Scene, Solved } from "./protocol";

export interface Quantity {
  name: string;
  title: string;
  unit: string;
  /** What one of the unit is in SI. */
  si: number;
  /** Whether both signs mean something: colours are then centred at zero. */
  signed: boolean;
  what: string;
  /** Between each two stations in SI, where it is known. */
  of(scene: Scene, solved: Solved): number[] | undefined;
}

const strain = (component: number) => (scene: Scene, solved: Solved): number[] => strainsOf(scene, solved).map((strains) => strains[component]!);
const moment = (component: number) => (scene: Scene, solved: Solved): number[] | undefined =>
  solved.moments ? overSections(scene, solved, solved.moments).map((moments) => moments[component]!) : undefined;

const axis = { x: "about the x axis of the cross-section", y: "about the y axis of the cross-section" };

export const QUANTITIES: readonly Quantity[] = [
  { name: "bending-x", title: "Bending κx", unit: "1/m", si: 1, signed: true, what: `curvature ${axis.x}`, of: strain(0) },
  { name: "bending-y", title: "Bending κy", unit: "1/m", si: 1, signed: true, what: `curvature ${axis.y}`, of: strain(1) },
  {
    name: "curvature", title: "Curvature", unit: "1/m", si: 1, signed: false, what: "size of the curvature, whatever the axis: 1 over the radius of the bend",
    of: (scene, solved) => strainsOf(scene, solved).map(([x, y]) => Math.hypot(x, y)),
  },
  { name: "twist", title: "Twist", unit: "1/m", si: 1, signed: true, what: "rotation of cross-sections about the backbone for each metre", of: strain(2) },
  { name: "shear-x", title: "Shear x", unit: "%", si: 1e-2, signed: true, what: "sliding of cross-sections along their x axis", of: strain(3) },
  { name: "shear-y", title: "Shear y", unit: "%", si: 1e-2, signed: true, what: "sliding of cross-sections along their y axis", of: strain(4) },
  { name: "strain", title: "Stretch", unit: "%", si: 1e-2, signed: true, what: "lengthening of the backbone; negative where it is compressed", of: strain(5) },
  { name: "moment-x", title: "Moment Mx", unit: "mN·m", si: 1e-3, signed: true, what: `moment of the backbone itself ${axis.x}, without that of the cables`, of: moment(0) },
  { name: "moment-y", title: "Moment My", unit: "mN·m", si: 1e-3, signed: true, what: `moment of the backbone itself ${axis.y}, without that of the cables`, of: moment(1) },
  { name: "torsion", title: "Torsion Mz", unit: "mN·m", si: 1e-3, signed: true, what: "moment of the backbone itself about its tangent", of: moment(2) },
  {
    name: "moment", title: "Bending moment", unit: "mN·m", si: 1e-3, signed: false, what: "size of the bending moment of the backbone itself",
    of: (scene, solved) => (solved.moments ? overSections(scene, solved, solved.moments).map(([x, y]) => Math.hypot(x, y)) : undefined),
  },
];

export function quantity(name: string): Quantity | undefined {
  return QUANTITIES.find((one) => one.name === name);
}
